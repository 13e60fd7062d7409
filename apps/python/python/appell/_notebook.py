"""Pages and pictures in a notebook."""

from __future__ import annotations

import html
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

Progress = Callable[[str], Any]


def framed(page: str, height: int = 480) -> str:
    """A page in a frame of a notebook. An animated page has the given height; a static one is as tall as its content,
    up to that height."""
    if "<script" in page:
        # Scripts have no access to the notebook.
        kind = 'sandbox="allow-scripts"'
    else:
        tall = f"Math.min({height}, this.contentDocument.body.offsetHeight + 48)"
        kind = f"""sandbox="allow-same-origin" onload="this.style.height = {tall} + 'px'\""""
    return (
        f'<iframe srcdoc="{html.escape(page, quote=True)}" {kind} '
        f'style="width:100%;height:{height}px;border:0"></iframe>'
    )


class Page:
    """A page for a browser, shown in a frame by a notebook."""

    def __init__(self, text: str, height: int = 480):
        self.text = text
        self._height = height

    def _repr_html_(self) -> str:
        return framed(self.text, self._height)

    def save(self, path: str | Path) -> None:
        """Writes the page as one self-contained file."""
        Path(path).write_text(self.text, encoding="utf-8")

    def __repr__(self) -> str:
        return f"<page of {len(self.text) // 1024 + 1} kB; .save(path) writes it>"


class Picture:
    """A picture as SVG."""

    def __init__(self, svg: str):
        self.svg = svg

    def _repr_svg_(self) -> str:
        return self.svg

    def save(self, path: str | Path) -> None:
        """Writes the picture as SVG."""
        Path(path).write_text(self.svg, encoding="utf-8")

    def __repr__(self) -> str:
        return f"<picture of {len(self.svg) // 1024 + 1} kB; .save(path) writes it>"


class Reporter:
    """Reports the stages of a computation on one line of a terminal or of a notebook's output."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._handle: Any = None
        self._shown = False

    def __call__(self, stage: str) -> None:
        line = f"{stage} … ({time.monotonic() - self._start:.0f} s)"
        display = _notebook_display()
        if display is not None:
            shown = {"text/plain": line}
            if self._handle is None:
                self._handle = display(shown, raw=True, display_id=True)
            else:
                self._handle.update(shown, raw=True)
        elif sys.stderr.isatty():
            sys.stderr.write(f"\r\x1b[K{line}")
            sys.stderr.flush()
            self._shown = True

    def __enter__(self) -> Reporter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._handle is not None:
            line = f"done in {time.monotonic() - self._start:.1f} s"
            self._handle.update({"text/plain": line}, raw=True)
        elif self._shown:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()


class Silent(Reporter):
    """Reports the stages to a user's function, or not at all."""

    def __init__(self, tell: Progress | None):
        super().__init__()
        self._tell = tell

    def __call__(self, stage: str) -> None:
        if self._tell is not None:
            self._tell(stage)


def reporter(progress: Progress | bool) -> Reporter:
    """Progress on screen, to a user's function, or none."""
    if callable(progress):
        return Silent(progress)
    return Reporter() if progress else Silent(None)


def _notebook_display() -> Any:
    """The function `display` of a notebook, if this runs in one."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is None or not hasattr(shell, "kernel"):
        return None
    from IPython.display import display

    return display
