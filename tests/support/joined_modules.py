"""ES modules that import each other, and what joins them."""

from __future__ import annotations

from padstudio.web.pages.bundles import Bundle, bundle

MODULES = {
    "page/page.js": """import * as words from "../shared/words.js";
import {
  double as twice,
  Counter,
} from "../shared/numbers.js";

log(words.greet("you"), twice(4), new Counter().next());
""",
    "shared/words.js": """import { double } from "./numbers.js";
log("words");
/** @param {import("./numbers.js").Counter} unused */
export const greet = (name) => `hello ${name} ${double(1)}`;
""",
    "shared/numbers.js": """log("numbers");
const by = 2;
export function double(x) {
  return by * x;
}
export class Counter {
  next() { return 1; }
}
export async function* never() {}
""",
}


def joined(**changed: str) -> Bundle:
    texts = MODULES | {name.replace("__", "/") + ".js": text for name, text in changed.items()}
    return bundle("page/page.js", texts.__getitem__)
