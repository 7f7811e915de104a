// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis {

/// A word that the printed report or the page uses: a column's name, a verdict.
struct ReportTerm {
  std::string name;  ///< as it is printed
  std::string meaning;
};

/// All of them, in the order in which a reader meets them.
const std::vector<ReportTerm>& report_terms();

}  // namespace trellis
