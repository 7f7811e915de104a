// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/views/latex.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace trellis {

namespace {

/// Characters with a meaning in LaTeX, and characters that its fonts lack.
constexpr std::array<std::pair<std::string_view, std::string_view>, 22> signs = {{{"\\", "\\textbackslash{}"},
                                                                                  {"%", "\\%"},
                                                                                  {"&", "\\&"},
                                                                                  {"#", "\\#"},
                                                                                  {"$", "\\$"},
                                                                                  {"_", "\\_"},
                                                                                  {"{", "\\{"},
                                                                                  {"}", "\\}"},
                                                                                  {"~", "\\textasciitilde{}"},
                                                                                  {"^", "\\textasciicircum{}"},
                                                                                  {"<", "$<$"},
                                                                                  {">", "$>$"},
                                                                                  {"|", "$|$"},
                                                                                  {"±", "$\\pm$"},
                                                                                  {"≥", "$\\geq$"},
                                                                                  {"≤", "$\\leq$"},
                                                                                  {"×", "$\\times$"},
                                                                                  {"−", "$-$"},
                                                                                  {"–", "--"},
                                                                                  {"’", "'"},
                                                                                  {"…", "\\ldots{}"},
                                                                                  {"·", "$\\cdot$"}}};

/// Appends the replacement of the character at `at`; returns the number of bytes that it read.
std::size_t add_sign(std::string_view text, std::size_t at, std::string& out) {
  const auto* const found = std::find_if(signs.begin(), signs.end(),
                                         [&](const auto& sign) { return text.substr(at).starts_with(sign.first); });
  if (found == signs.end()) {
    out += text[at];
    return 1;
  }
  out += found->second;
  return found->first.size();
}

/// Converts text with bold and code; `<br>` becomes `line_break`.
std::string inline_text(std::string_view text, std::string_view line_break) {
  std::string out;
  bool bold = false;
  bool code = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view rest = text.substr(at);
    if (!code && rest.front() == '\\' && rest.size() > 1) {
      at += 1 + add_sign(text, at + 1, out);
    } else if (rest.front() == '`') {
      out += code ? "}" : "\\texttt{";
      code = !code;
      ++at;
    } else if (!code && rest.starts_with("**")) {
      out += bold ? "}" : "\\textbf{";
      bold = !bold;
      at += 2;
    } else if (!code && rest.starts_with("<br>")) {
      out += line_break;
      at += 4;
    } else {
      at += add_sign(text, at, out);
    }
  }
  if (code) out += '}';
  if (bold) out += '}';
  return out;
}

/// Returns the cells of a table's row: the text between its bars; ignores bars that are escaped or in code.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::string cell;
  bool code = false;
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line[i] == '`') code = !code;
    if (line[i] == '\\' && !code && i + 1 < line.size()) {
      cell += line.substr(i, 2);
      ++i;
    } else if (line[i] == '|' && !code) {
      const std::size_t from = cell.find_first_not_of(' ');
      const std::size_t to = cell.find_last_not_of(' ');
      cells.push_back(from == std::string::npos ? "" : cell.substr(from, to - from + 1));
      cell.clear();
    } else {
      cell += line[i];
    }
  }
  return cells;
}

bool has_lines(const std::string& cell) { return cell.find("<br>") != std::string::npos; }

std::string cell_text(const std::string& cell) {
  std::string text = inline_text(cell, " \\\\ ");
  // After a line break LaTeX takes "[" for the break's own option.
  const std::string option = "\\\\ [";
  for (auto at = text.find(option); at != std::string::npos; at = text.find(option)) text.insert(at + 3, "{}");
  if (text.starts_with('[')) text.insert(0, "{}");
  return has_lines(cell) ? "\\begin{tabular}[t]{@{}r@{}}" + text + "\\end{tabular}" : text;
}

bool is_rule(const std::string& line) { return line.find_first_not_of("|-: ") == std::string::npos; }

/// The first row is the heading, the second one the rule below it.
std::string table(const std::vector<std::string>& lines) {
  const std::size_t columns = cells_of(lines.front()).size();
  // Scales a table to the width of the text if it is wider.
  std::string out =
      "\\par\\medskip\\noindent\n\\resizebox{\\ifdim\\width>\\linewidth\\linewidth\\else\\width\\fi}{!}{%\n";
  out += fmt::format("\\begin{{tabular}}{{l{}}}\n\\toprule\n", std::string(columns > 0 ? columns - 1 : 0, 'r'));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i == 1 && is_rule(lines[i])) {
      out += "\\midrule\n";
      continue;
    }
    const std::vector<std::string> cells = cells_of(lines[i]);
    for (std::size_t c = 0; c < cells.size(); ++c) out += (c == 0 ? "" : " & ") + cell_text(cells[c]);
    out += " \\\\\n";
    if (i + 1 < lines.size() && std::any_of(cells.begin(), cells.end(), has_lines)) out += "\\addlinespace\n";
  }
  return out + "\\bottomrule\n\\end{tabular}}\n\n";
}

}  // namespace

std::string latex(const std::string& markdown) {
  std::string out = "% \\usepackage{booktabs,graphicx}\n\n";
  std::istringstream text(markdown);
  std::vector<std::string> rows;
  const auto end_table = [&] {
    if (!rows.empty()) out += table(rows);
    rows.clear();
  };
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with('|')) {
      rows.push_back(line);
      continue;
    }
    end_table();
    const std::size_t level = line.find_first_not_of('#');
    if (line.empty() || level == std::string::npos) continue;
    constexpr std::size_t deepest = 3;
    if (level == 1 && line[level] == ' ') {
      // The sections, and the title, are those of the document that reads the file.
      out += "% " + line.substr(level + 1) + "\n\n";
    } else if (level > 1 && level <= deepest && line[level] == ' ') {
      out += fmt::format("\\par\\bigskip\\noindent\\textbf{{{}}}\\par\\nobreak\\smallskip\n\n",
                         inline_text(line.substr(level + 1), " "));
    } else {
      out += "\\noindent " + inline_text(line, "\\\\") + "\n\n";
    }
  }
  end_table();
  return out;
}

}  // namespace trellis
