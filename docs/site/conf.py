# SPDX-License-Identifier: GPL-3.0-or-later
"""The site of the documentation, for Sphinx 5.3 with MyST and the theme Furo. scripts/docs builds it."""

import pathlib

from pygments.lexer import RegexLexer, bygroups, using
from pygments.lexers import BashLexer, LuaLexer
from pygments.token import Generic

project = "Trellis"
html_title = "Trellis"
root_doc = "index"
extensions = ["myst_parser", "sphinx_copybutton"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["**.lua", "**.cpp"]

# Anchors as GitHub makes them, which the links of the pages name.
myst_heading_anchors = 4
# Terms such as "SE_T(Q)" and "--json" stand as they are typed.
smartquotes = False

# Transcripts are in no language that a lexer accepts whole.
suppress_warnings = ["misc.highlighting_failure"]
highlight_language = "text"
pygments_style = "tango"
pygments_dark_style = "native"

html_theme = "furo"
html_static_path = [str(pathlib.Path(__file__).parent / "static")]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_theme_options = {
    "light_css_variables": {
        "color-brand-primary": "#1b6f4a",
        "color-brand-content": "#1b6f4a",
    },
    "dark_css_variables": {
        "color-brand-primary": "#6fce9f",
        "color-brand-content": "#6fce9f",
    },
}

# What "copy" leaves out: prompts, and the lines that a command prints.
copybutton_prompt_text = r"\$ |trellis> |\.\.> |>> "
copybutton_prompt_is_regexp = True
copybutton_only_copy_prompt_lines = True


class TranscriptLexer(RegexLexer):
    """Commands of a shell and inputs of a session, with what is printed below them."""

    name = "Trellis transcript"
    tokens = {
        "root": [
            (r"^(\$ )(.*\n)", bygroups(Generic.Prompt, using(BashLexer))),
            (r"^(trellis> |\.\.> )(.*\n)", bygroups(Generic.Prompt, using(LuaLexer))),
            (r".*\n", Generic.Output),
        ]
    }


def setup(app):
    """Registers the lexer."""
    app.add_lexer("console", TranscriptLexer)
