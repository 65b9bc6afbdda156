#!/bin/sh
# Finds, or installs from the distribution, what the tests need beside Python: a Chromium for the
# pages, poppler's pdftoppm for measuring printed sheets, curl for the README's commands, PostgreSQL's
# programs, with which the tests start a server of their own, GStreamer's RTSP server with the bindings
# for the system's Python, which streams as a network camera does.
set -eu

have() { command -v "$1" >/dev/null 2>&1; }

# Debian packs the headless shell, which takes far less time than a Chromium with windows.
has_headless_shell() { have apt-get && grep -qsx 'ID=debian' /etc/os-release; }

have_chromium() {
    [ -n "${PADSTUDIO_CHROMIUM:-}" ] && [ -x "${PADSTUDIO_CHROMIUM}" ] && return 0
    have chromium-headless-shell && return 0
    has_headless_shell && return 1
    for name in chromium chromium-browser google-chrome google-chrome-stable; do
        have "$name" && return 0
    done
    [ -x "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome" ] ||
        [ -x "/Applications/Chromium.app/Contents/MacOS/Chromium" ]
}

have_postgresql() {
    [ -n "${PADSTUDIO_TEST_POSTGRESQL:-}" ] || have initdb && return 0
    for program in /usr/lib/postgresql/*/bin/initdb /opt/homebrew/opt/*/bin/initdb /usr/local/opt/*/bin/initdb; do
        [ -x "$program" ] && return 0
    done
    return 1
}

have_gstreamer() {
    for python in /usr/bin/python3 /opt/homebrew/bin/python3 /usr/local/bin/python3; do
        [ -x "$python" ] && "$python" "$(dirname "$0")/support/gstreamer_camera.py" --check >/dev/null 2>&1 &&
            return 0
    done
    return 1
}

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi; }

debian_packages=""
brew_packages=""
have_chromium || {
    debian_packages="$debian_packages chromium$(! has_headless_shell || echo -headless-shell)"
    brew_packages="$brew_packages google-chrome"
}
have pdftoppm || { debian_packages="$debian_packages poppler-utils"; brew_packages="$brew_packages poppler"; }
have curl || { debian_packages="$debian_packages curl"; brew_packages="$brew_packages curl"; }
have_postgresql || { debian_packages="$debian_packages postgresql"; brew_packages="$brew_packages postgresql"; }
have_gstreamer || {
    debian_packages="$debian_packages python3-gi gir1.2-gst-rtsp-server-1.0 gir1.2-gst-plugins-base-1.0"
    debian_packages="$debian_packages gstreamer1.0-plugins-base gstreamer1.0-plugins-good gstreamer1.0-plugins-bad"
    brew_packages="$brew_packages gstreamer pygobject3"
}
[ -n "$debian_packages" ] || exit 0

# Names are words of their own on purpose in what follows.
# shellcheck disable=SC2086
if have apt-get; then
    as_root apt-get update -qq
    # Debian would otherwise start a server for the whole machine.
    if ! have_postgresql && [ ! -e /etc/postgresql-common/createcluster.conf ]; then
        as_root mkdir -p /etc/postgresql-common
        echo 'create_main_cluster = false' | as_root tee /etc/postgresql-common/createcluster.conf >/dev/null
    fi
    # Ubuntu's package of that name is a snap launcher, found as chromium-browser as well.
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends $debian_packages
elif have brew; then
    brew install --quiet $brew_packages
else
    echo "error: install these first:$debian_packages" >&2
    exit 1
fi
