import pytest

from padstudio.errors import NotFoundError
from padstudio.media.sources import find_frames, kind_of


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name in (
        "f10.jpg",
        "f2.JPG",
        "f1.png",
        "notes.txt",
        "deep/g1.jpg",
        "deep/er/h1.tif",
        "clip.MP4",
    ):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    (tmp_path / "folder.jpg").mkdir()
    monkeypatch.chdir(tmp_path)


def names(*sources):
    return [path.as_posix() for path in find_frames(sources)]


@pytest.mark.usefixtures("folder")
def test_a_folder_is_its_pictures_and_videos_with_numbers_by_value():
    assert names(".") == ["clip.MP4", "f1.png", "f2.JPG", "f10.jpg"]


@pytest.mark.usefixtures("folder")
def test_patterns():
    assert names("f*") == ["f1.png", "f2.JPG", "f10.jpg"]
    assert names("**/*.jpg") == ["deep/g1.jpg", "f10.jpg"]
    assert names("deep/**/*") == ["deep/er/h1.tif", "deep/g1.jpg"]


@pytest.mark.usefixtures("folder")
def test_sources_keep_their_order_and_name_each_file_once():
    assert names("f10.jpg", "f*", "f1.png") == ["f10.jpg", "f1.png", "f2.JPG"]


@pytest.mark.usefixtures("folder")
def test_a_file_named_outright_is_taken_whatever_it_is_called():
    assert names("notes.txt") == ["notes.txt"]


def test_a_file_that_looks_like_a_pattern(tmp_path):
    path = tmp_path / "f[1].jpg"
    path.touch()
    assert find_frames([str(path)]) == [path]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("source", ["gone.jpg", "gone/*.jpg", "*.txt", "folder.jpg", ""])
def test_a_source_without_pictures_is_named(source):
    with pytest.raises(NotFoundError, match=r"no picture, video or recording there") as caught:
        find_frames(["f1.png", source])
    assert caught.value.message.startswith(f"{source}: ")


@pytest.mark.usefixtures("folder")
def test_videos_are_known_by_content_else_by_name(tmp_path):
    (tmp_path / "notes.txt").write_bytes(b"\0\0\0\x20ftypisom" + bytes(40))
    (tmp_path / "f2.JPG").write_bytes(b"\xff\xd8\xff")
    (tmp_path / "photo.mp4").write_bytes(b"\xff\xd8\xff")
    (tmp_path / "text.mov").write_text("no video")
    found = {path.name for path in tmp_path.iterdir() if kind_of(path) == "video"}
    assert found == {"notes.txt", "clip.MP4", "text.mov"}
    assert kind_of(tmp_path / "gone.jpg") == "still"
