"""The ways from footage to poses that the documents show do what they say."""

import csv
import json
import shutil

import av
import httpx
import pytest
from document_blocks import ROOT, block, run_python, run_shell, serving

FOOTAGE = ROOT / "tests" / "footage"
FRAMES = 6


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the first frames of a landing, its pad, and its camera."""
    folder = tmp_path_factory.mktemp("flight")
    shutil.copy(FOOTAGE / "pad_a.json", folder / "pad.json")
    shutil.copy(FOOTAGE / "camera_drone_2k7.yaml", folder / "camera.yaml")
    with (
        av.open(str(FOOTAGE / "flights" / "landing.mp4")) as source,
        av.open(str(folder / "flight.mp4"), "w") as target,
    ):
        stream = target.add_stream_from_template(source.streams.video[0])
        for number, packet in enumerate(source.demux(video=0)):
            if number < FRAMES and packet.dts is not None:
                packet.stream = stream
                target.mux(packet)
    return folder


@pytest.fixture(scope="module")
def address(folder):
    """The address of a server."""
    with serving(folder / "data") as address:
        yield address


def heights_are_true(heights_mm):
    truth = json.loads((FOOTAGE / "flights" / "landing.truth.json").read_text(encoding="utf-8"))
    true = [frame["position_mm"][2] for frame in truth["frames"][:FRAMES]]
    assert len(heights_mm) == FRAMES
    assert heights_mm == pytest.approx(true, rel=0.02)


def heights_of_csv(path):
    with path.open(encoding="utf-8", newline="") as file:
        return [float(row["camera_in_pad_z_mm"]) for row in csv.DictReader(file)]


def test_the_readme_on_the_command_line(folder):
    run_shell(block("README.md", "sh", "--resume"), folder)
    rows = (folder / "flight.tum.txt").read_text(encoding="utf-8").splitlines()
    heights_are_true([1000 * float(row.split()[3]) for row in rows if not row.startswith("#")])


def test_the_documents_in_curl(folder, address):
    text = block("docs/flights-rest.md", "sh", "pads/import")
    progress = run_shell(text, folder, address)
    assert '"state":"done"' in progress
    heights_are_true(heights_of_csv(folder / "poses.csv"))
    assert (folder / "poses.tum.txt").read_text(encoding="utf-8").startswith("# timestamp tx")


def test_the_documents_after_a_broken_connection(folder, address):
    size = (folder / "flight.mp4").stat().st_size
    text = (
        block("docs/flights-rest.md", "sh", "pads/import").split("\n\n")[0]
        + f"""
upload=$(curl -sSf $api/uploads -H 'Tus-Resumable: 1.0.0' -H "Upload-Length: {size}" \\
  -H 'Content-Type: application/offset+octet-stream' -X POST -T - < start | id)
{block("docs/flights-rest.md", "sh", "PATCH")}
curl -sSf $api/uploads/$upload
"""
    )
    (folder / "start").write_bytes((folder / "flight.mp4").read_bytes()[:5000])
    answer = json.loads(run_shell(text, folder, address))
    assert (answer["complete"], answer["offset"], answer["kind"]) == (True, size, "video")


def test_the_readme_in_curl(folder, address):
    first = block("README.md", "sh", "api/v1").replace("samples/", "")
    stored = "\n".join(line for line in first.splitlines() if "detect" not in line)
    run_shell(f"{stored}\n{block('README.md', 'sh', 'upload=')}", folder, address)
    heights_are_true(heights_of_csv(folder / "poses.csv"))


def test_the_documents_in_python(folder, address):
    said = run_python(block("docs/flights-rest.md", "python", "def upload"), folder, address)
    assert f"done {FRAMES} of {FRAMES} frames" in said
    lines = (folder / "poses.jsonl").read_text(encoding="utf-8").splitlines()
    heights_are_true([json.loads(line)["position_mm"][2] for line in lines])


def test_the_readme_in_python(folder, address):
    said = run_python(block("README.md", "python", "tusclient"), folder, address)
    heights_are_true([json.loads(line)["position_mm"][2] for line in said.splitlines()])


def test_uploads_as_their_document_shows(folder, address):
    by_python = run_python(block("docs/uploads.md", "python", "TusClient"), folder, address).strip()
    by_curl = json.loads(run_shell(block("docs/uploads.md", "sh", "curl"), folder, address))
    assert (by_curl["complete"], by_curl["name"]) == (True, "flight.mp4")
    found = httpx.get(
        f"{address}/api/v1/uploads", params={"sha256": by_curl["sha256"]}, timeout=60
    ).json()
    assert {by_python, by_curl["id"]} <= {upload["id"] for upload in found["items"]}
