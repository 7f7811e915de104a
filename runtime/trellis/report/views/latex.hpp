// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace trellis {

/// Converts the Markdown of reports (headings, paragraphs, tables; bold, code, escapes and line breaks in them) to
/// LaTeX for \input: sections without numbers and tables with the rules of booktabs. It requires the packages booktabs
/// and, for wide tables, graphicx.
std::string latex(const std::string& markdown);

}  // namespace trellis
