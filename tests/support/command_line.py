"""The command line, called in this process."""

from typer.testing import CliRunner

from padstudio.cli.program import app

# Wide enough that no option of a help text is broken over lines.
ENVIRONMENT = {"COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}


def run(*arguments):
    return CliRunner(env=ENVIRONMENT).invoke(app, [str(a) for a in arguments])


def assert_one_line_error(result, code, exit_code=2):
    assert result.exit_code == exit_code
    assert result.stderr.startswith("error: ")
    assert result.stderr.endswith(f" ({code})\n")
    assert result.stderr.count("\n") == 1
    assert result.stdout == ""
