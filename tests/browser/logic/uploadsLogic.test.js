import { fingerprint, meaningOf, metadata, nextChunkBytes, retryDelayMs } from "/static/js/server/uploads/tusLogic.js";
import {
  fewPictures, fromLists, fromStorage, hasTopics, isLive, mayBringCamera, nextToSend, readyIds, rowsOf, toStorage, totals, withFiles, withItem,
} from "/static/js/flights/uploadsLogic.js";
import { contains, equal } from "./check.js";

const file = (name, size = 1000, lastModified = 7) => ({ name, size, lastModified });
const chosen = (names, folder = "") => names.map((name) => ({ file: file(name), folder }));
const KB = 1024;

export const tests = {
  "a few pictures alone may be meant for Diagnose": () => {
    const few = (...names) => fewPictures(names.map((name) => ({ name })));
    equal([few("a.jpg"), few("a.PNG", "b.tif", "c.webp")], [true, true]);
    equal([few(), few("a.mp4"), few("a.jpg", "b.srt"), few("a.jpg", "b.jpg", "c.jpg", "d.jpg")], [false, false, false, false]);
  },
  "recordings have topics, and may bring their camera": () => {
    const ask = (...names) => [hasTopics, mayBringCamera].map((is) => is(names.map((name) => ({ name }))));
    equal([ask("a.bag"), ask("a.MCAP", "b.zip")], [[true, true], [true, true]]);
    equal([ask(), ask("a.mp4"), ask("a.mp4", "b.db3")], [[false, false], [false, false], [true, false]]);
  },
  "a live recording is known by its session's file, or by what the server says of a zip": () => {
    const item = (name, kind = null, status = "done") => ({ name, kind, status });
    const live = [[item("0001.mp4"), item("session.json")], [item("a.zip", "live")]];
    const others = [[item("0001.mp4"), item("a.json")], [item("a.zip", "stills")], [item("session.json", null, "refused")], []];
    equal([...live, ...others].map(isLive), [true, true, false, false, false, false]);
  },
  "metadata is base64 of UTF-8": () => {
    equal(metadata({ filename: "flug ü.mp4" }), `filename ${btoa("flug \u00c3\u00bc.mp4")}`);
  },
  "parts grow towards a second a request, at most twofold, and shrink at once": () => {
    equal(nextChunkBytes(1024 * KB, 10), 2048 * KB);
    equal(nextChunkBytes(1024 * KB, 1000), 1024 * KB);
    equal(nextChunkBytes(1024 * KB, 2000), 512 * KB);
    equal([nextChunkBytes(256 * KB, 60_000), nextChunkBytes(32 * KB * KB, 1)], [256 * KB, 32 * KB * KB]);
  },
  "tries come ever rarer, up to half a minute": () => {
    equal([1, 2, 3, 5, 6, 50].map(retryDelayMs), [1000, 2000, 4000, 16_000, 30_000, 30_000]);
  },
  "refusals that pass are tried again, a lost upload begins anew, others are final": () => {
    equal([0, 409, 460, 500, 503].map(meaningOf), Array(5).fill("again"));
    equal([404, 410].map(meaningOf), ["anew", "anew"]);
    equal([400, 401, 413, 422, 507].map(meaningOf), Array(5).fill("final"));
  },
  "files come in the order of their names, 2 before 10, each once": () => {
    const items = withFiles([], [...chosen(["f10.jpg", "f2.jpg"]), ...chosen(["f2.jpg"])]);
    equal(items.map((item) => item.name), ["f2.jpg", "f10.jpg"]);
    equal(withFiles(items, chosen(["f2.jpg"])).length, 2);
  },
  "an empty file is refused and does not count": () => {
    const items = withFiles([], [{ file: file("empty.mp4", 0), folder: "" }, ...chosen(["a.mp4"])]);
    equal(items.map((item) => item.status), ["waiting", "refused"]);
    equal(totals(items), { sent: 0, size: 1000, done: 0, total: 1 });
  },
  "no more are sent at once than there are slots": () => {
    const items = withFiles([], chosen(["a", "b", "c"]));
    const busy = withItem(items, items[0].key, { status: "sending" });
    equal(nextToSend(busy, 2).map((item) => item.name), ["b"]);
    equal(nextToSend(busy, 1), []);
  },
  "a flight can be made when every file that is not refused is there": () => {
    let items = withFiles([], [...chosen(["a", "b"]), { file: file("c", 0), folder: "" }]);
    equal(readyIds(items), null);
    items = withItem(items, items[1].key, { status: "done", id: "2" });
    equal(readyIds(items), null);
    items = withItem(items, items[0].key, { status: "done", id: "1" });
    equal(readyIds(items), ["1", "2"]);
    equal(readyIds([]), null);
  },
  "after a reload a file waits to be chosen again, and goes on where it was": () => {
    let items = withFiles([], chosen(["a.mp4"]));
    items = withItem(items, items[0].key, { status: "sending", url: "/u/1", offset: 400 });
    const restored = fromStorage(toStorage(items));
    equal(restored.map(({ status, file: held, offset }) => [status, held, offset]), [["waiting", null, 400]]);
    equal([rowsOf(restored)[0].status, rowsOf(restored)[0].troubled, nextToSend(restored, 2)], ["absent", true, []]);
    contains(rowsOf(restored)[0].note, "Choose the file again");
    const again = withFiles(restored, chosen(["a.mp4"]));
    equal(again.map(({ url, status }) => [url, status]), [["/u/1", "waiting"]]);
    equal(nextToSend(again, 2).length, 1);
  },
  "lists of several tabs are one, each file once, as the first has it": () => {
    const [own, other] = [withFiles([], chosen(["b.mp4"])), withFiles([], chosen(["a.mp4", "b.mp4"]))];
    const texts = [own, other].map((items, at) => toStorage(items.map((item) => ({ ...item, url: `/u/${at}` }))));
    equal(fromLists([...texts, "{"]).map(({ name, url }) => [name, url]), [["a.mp4", "/u/1"], ["b.mp4", "/u/0"]]);
  },
  "another file of the same name is another file": () => {
    equal(fingerprint(file("a", 1000), "") === fingerprint(file("a", 1001), ""), false);
    equal(fingerprint(file("a", 1000, 8), "") === fingerprint(file("a"), ""), false);
  },
  "what is stored by others is not taken": () => {
    for (const text of [null, "", "{", "{}", "[null, 3, {}]"]) equal(fromStorage(text), []);
  },
  "many stills of a folder are one line": () => {
    const names = Array.from({ length: 20 }, (_, at) => `${at}.jpg`);
    let items = withFiles([], chosen(names, "flight"));
    items = withItem(items, items[0].key, { status: "done", id: "1" });
    const rows = rowsOf(items);
    equal([rows.length, rows[0].keys.length, rows[0].share], [1, 20, 0.05]);
    contains(rows[0].note, "1 of 20 stills sent");
    equal(rowsOf(withFiles([], chosen(names.slice(0, 3), "few"))).length, 3);
  },
};
