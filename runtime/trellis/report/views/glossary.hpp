// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace trellis {

/// A term of the printed report or the page: a column's name, a verdict.
struct ReportTerm {
  std::string name;  ///< as printed
  std::string meaning;
};

/// Returns all terms, in the order of the report.
const std::vector<ReportTerm>& report_terms();

}  // namespace trellis
