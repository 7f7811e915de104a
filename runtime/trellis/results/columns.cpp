// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/results/columns.hpp>

#include <fmt/format.h>

#include <algorithm>

#include <trellis/base/error.hpp>
#include <trellis/results/run_json.hpp>

namespace trellis::json {

namespace {

/// A text of a column; infinite numbers are texts too, which stand for themselves.
bool is_text(const Json& value) { return value.is_string() && value != "inf" && value != "-inf"; }

}  // namespace

// Writing -------------------------------------------------------------------------------------------------------------

void ColumnWriter::Column::append(const std::string& entry) {
  if (rows == 0) first = entry;
  if (values.empty() && entry != first) {
    values = first;
    for (std::size_t i = 1; i < rows; ++i) (values += ',') += first;
  }
  if (!values.empty()) (values += ',') += entry;
  ++rows;
}

std::size_t ColumnWriter::Column::number_of(const std::string& text) {
  const auto [at, added] = numbers.emplace(text, texts.size());
  if (added) texts.push_back(text);
  return at->second;
}

void ColumnWriter::Column::append(const Json& value) {
  if (kind == Kind::plain && is_text(value)) kind = Kind::text;
  if (kind == Kind::plain && value.is_array()) kind = Kind::list;
  if (kind == Kind::list && value.is_array() && !value.empty() && !value.front().is_number()) {
    kind = value.front().is_array() ? Kind::pairs : Kind::texts;
  }
  if (value.is_null() || kind == Kind::plain || kind == Kind::list || (kind == Kind::text && !value.is_string())) {
    append(dump(value));
  } else if (kind == Kind::text) {
    append(std::to_string(number_of(value.get<std::string>())));
  } else {
    std::string entry;
    for (const Json& one : value) {
      const Json& text = kind == Kind::pairs ? one.at(0) : one;
      entry += (entry.empty() ? "" : ",") + std::to_string(number_of(text.get<std::string>()));
      if (kind == Kind::pairs) entry += ',' + dump(one.at(1));
    }
    append('[' + entry + ']');
  }
}

void ColumnWriter::Column::extend(std::size_t to) {
  while (rows < to) append(std::string("null"));
}

std::string ColumnWriter::Column::text() const {
  const bool equal = values.empty();
  if (equal && first == "null") return first;
  if (equal && kind == Kind::plain) return first;
  if (equal && kind == Kind::text) return dump(texts.front());
  std::string all = equal ? first : values;
  for (std::size_t i = 1; equal && i < rows; ++i) (all += ',') += first;
  all = '[' + all + ']';
  if (kind == Kind::plain || kind == Kind::list) return all;
  return fmt::format(R"({{"texts":{},"{}":{}}})", dump(texts), kind == Kind::pairs ? "pairs" : "at", all);
}

void ColumnWriter::add(const Json& object, const std::string& prefix) {
  for (const auto& [name, value] : object.items()) {
    if (value.is_object()) {
      add(value, prefix + name + '.');
      continue;
    }
    const auto [at, added] = at_.emplace(prefix + name, columns_.size());
    if (added) columns_.emplace_back().name = prefix + name;
    Column& column = columns_[at->second];
    column.extend(rows_);
    column.append(value);
  }
}

void ColumnWriter::add(const Json& row) {
  add(row, "");
  ++rows_;
}

std::string ColumnWriter::text(const std::string& indent) const {
  std::string out = "{\n" + indent + "\"rows\": " + std::to_string(rows_);
  for (Column column : columns_) {
    column.extend(rows_);
    const std::string values = column.text();
    // A member of an object that no row has.
    if (values == "null" && column.name.find('.') != std::string::npos) continue;
    out += fmt::format(",\n{}{}: {}", indent, dump(column.name), values);
  }
  return out + "\n" + indent.substr(0, indent.size() - 1) + "}";
}

// Reading -------------------------------------------------------------------------------------------------------------

ColumnReader::ColumnReader(const Json& table) : rows_(table.at("rows").get<std::size_t>()) {
  for (const auto& [name, values] : table.items()) {
    if (name == "rows") continue;
    Column column;
    column.values = &values;
    for (std::size_t begin = 0; begin <= name.size();) {
      const std::size_t end = std::min(name.find('.', begin), name.size());
      column.path.push_back(name.substr(begin, end - begin));
      begin = end + 1;
    }
    if (values.is_object()) {
      column.texts = &values.at("texts");
      column.pairs = values.contains("pairs");
      column.values = &values.at(column.pairs ? "pairs" : "at");
    }
    if ((column.values->is_array() || column.texts != nullptr) && column.values->size() != rows_) {
      throw Error(
          fmt::format("the column {} has {} values; its table has {} rows", name, column.values->size(), rows_));
    }
    columns_.push_back(std::move(column));
  }
}

Json ColumnReader::row(std::size_t i) const {
  Json out = Json::object();
  for (const Column& column : columns_) {
    const Json& value = column.values->is_array() ? (*column.values)[i] : *column.values;
    if (value.is_null() && column.path.size() > 1) continue;
    Json* place = &out;
    for (const std::string& name : column.path) place = &(*place)[name];
    if (column.texts == nullptr || value.is_null()) {
      *place = value;
    } else if (!value.is_array()) {
      *place = value.is_number() ? column.texts->at(value.get<std::size_t>()) : value;
    } else {
      *place = Json::array();
      for (std::size_t k = 0; k < value.size(); k += column.pairs ? 2 : 1) {
        const Json& text = column.texts->at(value[k].get<std::size_t>());
        place->push_back(column.pairs ? Json::array({text, value.at(k + 1)}) : text);
      }
    }
  }
  return out;
}

}  // namespace trellis::json
