"""Where the repository keeps what tests read."""

from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
ROOT = TESTS.parent
DOCS = ROOT / "docs"
FOOTAGE = TESTS / "footage"
SAMPLES = ROOT / "samples"
