// SPDX-License-Identifier: GPL-3.0-or-later
// Documents of results as objects within objects: each run with its levels, and each level with its scores, from the
// tables of the document (docs/formats.md).
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

namespace trellis::test {

/// Returns a row of a table with its texts, or null; names with points become objects within objects.
template <class Json>
Json table_row(const Json& table, std::size_t i) {
  Json row = Json::object();
  for (const auto& [name, column] : table.items()) {
    if (name == "rows") continue;
    Json value = column;
    if (column.is_array()) value = column.at(i);
    if (column.is_object()) {
      const bool pairs = column.contains("pairs");
      value = column.at(pairs ? "pairs" : "at").at(i);
      const auto text = [&](const Json& at) { return column.at("texts").at(at.template get<std::size_t>()); };
      if (value.is_array()) {
        Json list = Json::array();
        for (std::size_t k = 0; k < value.size(); k += pairs ? 2 : 1) {
          list.push_back(pairs ? Json{{"name", text(value.at(k))}, {"proposals", value.at(k + 1)}} : text(value.at(k)));
        }
        value = list;
      } else if (!value.is_null()) {
        value = text(value);
      }
    }
    Json* place = &row;
    std::size_t begin = 0;
    for (std::size_t end = name.find('.'); end != std::string::npos; end = name.find('.', begin)) {
      place = &(*place)[name.substr(begin, end - begin)];
      begin = end + 1;
    }
    (*place)[name.substr(begin)] = value;
  }
  return row;
}

/// Adds to each run its `levels`, to each level its `measure` as `tree.self`, `root.tree.self` and `oracle.tree`.
template <class Json>
Json with_levels(Json document) {
  for (Json& run : document.at("runs")) run["levels"] = Json::array();
  const Json levels = document.at("levels");
  for (std::size_t i = 0; i < levels.at("rows").template get<std::size_t>(); ++i) {
    Json row = table_row(levels, i);
    const auto run = row.at("run").template get<std::size_t>();
    row.erase("run");
    row["measure"] = nullptr;
    document.at("runs").at(run).at("levels").push_back(row);
  }
  const Json measure = document.at("measure");
  for (std::size_t i = 0; i < measure.at("rows").template get<std::size_t>(); ++i) {
    Json row = table_row(measure, i);
    const auto number = row.at("level").template get<std::size_t>();
    Json& level = document.at("runs").at(row.at("run").template get<std::size_t>()).at("levels").at(number);
    const bool own = row.at("space") == "own";
    const std::string path = row.at("path");
    const std::string role = row.at("role");
    for (const char* name : {"run", "level", "space", "path", "role"}) row.erase(name);
    Json& of = level["measure"];
    if (path != "self" && path != "cross") {
      of[path][role] = row;
      continue;
    }
    // The own space of the root is the root's.
    if (own || number == 0) of[role][path] = row;
    if (!own && number != 0) of["root"][role][path] = row;
  }
  return document;
}

}  // namespace trellis::test
