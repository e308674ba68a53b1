"""Configuration of the documentation site for Sphinx; `make docs` builds it."""

import json
import logging
import os
import re
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

# Notebooks run in kernels of this interpreter, which import the packages of this checkout and find its
# commands.
KERNELS = ROOT / "build/jupyter"
os.environ["JUPYTER_PATH"] = str(KERNELS)
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
os.environ["OMP_NUM_THREADS"] = "1"
os.environ["SDL_VIDEODRIVER"] = "dummy"
logging.getLogger("traitlets").setLevel(logging.WARNING)  # else each notebook that begins is a line

from sphinx.application import Sphinx  # noqa: E402

import swarm_gym  # noqa: E402
from experiments.playground.playground_page import playground_page  # noqa: E402
from experiments.site.markup import accessible, legible, to_restructured_text  # noqa: E402
from experiments.site.pages import on_site, write_pages  # noqa: E402
from swarm_gym.files import write_atomically  # noqa: E402

# Kernels say on each start that they use TCP, which is no news on a machine of one's own: errors only.
KERNEL = {
    "argv": [sys.executable, "-m", "ipykernel_launcher", "--log-level=40", "-f", "{connection_file}"],
    "display_name": "Python 3",
    "language": "python",
}
write_atomically(KERNELS / "kernels/python3/kernel.json", json.dumps(KERNEL))

project = "swarm_gym"
author = "The authors of swarm_gym"
project_copyright = author
version = release = swarm_gym.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "sphinx_design",
]
exclude_patterns = ["_build"]

myst_enable_extensions = ["attrs_inline", "colon_fence"]
myst_heading_anchors = 4

nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_execution_timeout = 300
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False

html_theme = "furo"
html_title = f"swarm_gym {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
copybutton_exclude = ".linenos, .gp, .go"


def setup(app: Sphinx) -> None:
    """Connect what this project adds to the build: generated pages, links and docstrings."""
    app.connect("builder-inited", _generate)
    app.connect("source-read", _lead_links)
    app.connect("autodoc-process-docstring", _translate_docstring, priority=400)  # before napoleon
    app.connect("autodoc-process-signature", _shorten_signature)
    app.connect("autodoc-skip-member", _skip_member)
    app.connect("build-finished", _finish)


def _generate(app: Sphinx) -> None:
    write_pages(Path(app.srcdir))


def _lead_links(_: Sphinx, docname: str, source: list[str]) -> None:
    source[0] = on_site(source[0], f"docs/{docname}.md", ROOT)


def _translate_docstring(_: Sphinx, __: str, ___: str, ____: Any, _____: Any, lines: list[str]) -> None:
    lines[:] = to_restructured_text(lines)


def _shorten_signature(
    _: Sphinx, __: str, ___: str, ____: Any, _____: Any, signature: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """Return the signature with arrays as `NDArray[float64]`, as the source has them."""

    def shortened(text: str | None) -> str | None:
        pattern = (
            r"~?(?:numpy\.)?ndarray\[tuple\[(?:~?typing\.)?Any, \.\.\.\], ~?(?:numpy\.)?dtype\[([^][]*)\]\]"
        )
        return text and re.sub(pattern, r"NDArray[\1]", text)

    return shortened(signature), shortened(returned)


def _skip_member(_: Sphinx, __: str, ___: str, found: Any, skip: bool, ____: Any) -> bool | None:
    """Skip fields of NamedTuples: the docstring of the class has them."""
    return True if str(getattr(found, "__doc__", "")).startswith("Alias for field number") else (skip or None)


def _finish(app: Sphinx, error: Exception | None) -> None:
    if error is None and app.builder.format == "html":
        for path in Path(app.outdir).rglob("*.html"):
            text = path.read_text(encoding="utf-8")
            if (better := legible(accessible(text), path.parent)) != text:
                path.write_text(better, encoding="utf-8")
        write_atomically(Path(app.outdir) / "play.html", playground_page())
