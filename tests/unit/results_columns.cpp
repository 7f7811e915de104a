// SPDX-License-Identifier: GPL-3.0-or-later
#include <string>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/results/columns.hpp>

#include "support/catch.hpp"

using namespace trellis;
using Json = json::ColumnWriter::Json;

namespace {

Json table_of(const std::vector<Json>& rows) {
  json::ColumnWriter writer;
  for (const Json& row : rows) writer.add(row);
  return Json::parse(writer.text());
}

}  // namespace

TEST_CASE("a table has the rows that were added", "[results]") {
  const std::vector<Json> rows = {
      Json::parse(
          R"({"run": 0, "name": "a", "x": 0.5, "part": {"of": 1}, "flags": [], "by": [["w", 3]], "at": [1, 2]})"),
      Json::parse(R"({"run": 1, "name": "b", "x": "inf", "flags": ["few", "late"], "by": [], "at": []})"),
      Json::parse(R"({"run": 1, "name": "a", "x": null, "part": {"of": 2}, "flags": ["few"], "by": [["v", 1], ["w", 2]],
                      "at": [3]})")};
  const Json table = table_of(rows);
  const json::ColumnReader reader(table);
  REQUIRE(reader.rows() == 3);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CAPTURE(i, reader.row(i).dump());
    CHECK(reader.row(i) == rows[i]);
  }
  CHECK(table.at("name").at("texts") == Json({"a", "b"}));
}

TEST_CASE("a column of equal values is one value", "[results]") {
  const Json row = Json::parse(R"({"run": 7, "name": "rrt", "solved": true, "none": null, "list": [1]})");
  const Json table = table_of({row, row, row});
  CHECK(table.at("run") == 7);
  CHECK(table.at("name") == "rrt");
  CHECK(table.at("solved") == true);
  CHECK(table.at("none").is_null());
  CHECK(table.at("list") == Json::parse("[[1], [1], [1]]"));
  for (std::size_t i = 0; i < 3; ++i) CHECK(json::ColumnReader(table).row(i) == row);
}

TEST_CASE("a column that begins late, or ends early, has nulls", "[results]") {
  const Json table = table_of({Json::parse(R"({"a": 1})"), Json::parse(R"({"b": "x"})"), Json::parse(R"({"a": 1})")});
  const json::ColumnReader reader(table);
  CHECK(reader.row(0) == Json::parse(R"({"a": 1, "b": null})"));
  CHECK(reader.row(1) == Json::parse(R"({"a": null, "b": "x"})"));
  CHECK(reader.row(2) == Json::parse(R"({"a": 1, "b": null})"));
}

TEST_CASE("a table without rows, and a damaged one", "[results]") {
  const Json empty = table_of({});
  CHECK(json::ColumnReader(empty).rows() == 0);
  const Json shorter = Json::parse(R"({"rows": 2, "a": [1]})");
  CHECK_THROWS_WITH(json::ColumnReader(shorter), "the column a has 1 values; its table has 2 rows");
  const Json nameless = Json::parse(R"({"a": [1]})");
  CHECK_THROWS_AS(json::ColumnReader(nameless), Json::exception);
}
