"""Headers that every answer carries."""

from __future__ import annotations

CONTENT_SECURITY_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; font-src 'self'; manifest-src 'self'; worker-src 'self'; "
    "form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
# Plotly places two style sheets in the page: an empty one, to which it adds rules, and one of maps,
# which changes with its version and is not missed where it is refused.
_CHART_STYLES = (
    "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='",
    "'sha256-ji27qzEtxXZW+7dun6UwjHXJ18e6WAin1VvNtkzIE/o='",
)
#: Pages with charts allow these, and like all others no further inline style or script.
CHARTS_POLICY = CONTENT_SECURITY_POLICY.replace(
    "style-src 'self'", f"style-src 'self' {' '.join(_CHART_STYLES)}"
)
#: What pages may ask the browser for: nothing; and where the camera is read, that alone.
NO_DEVICES = "camera=(), microphone=(), geolocation=()"
CAMERA_DEVICE = NO_DEVICES.replace("camera=()", "camera=(self)")
SECURITY_HEADERS = {
    "Content-Security-Policy": CONTENT_SECURITY_POLICY,
    "X-Content-Type-Options": "nosniff",
    "Permissions-Policy": NO_DEVICES,
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    # What an answer does not say otherwise is somebody's own data.
    "Cache-Control": "no-store",
}
