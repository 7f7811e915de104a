// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis {

/// The Markdown that reports write (headings, paragraphs, tables; bold, code, escapes and line breaks in them) as LaTeX
/// to be read by \input: sections without numbers and tables with the rules of booktabs. It needs the packages booktabs
/// and, for wide tables, graphicx.
std::string latex(const std::string& markdown);

}  // namespace trellis
