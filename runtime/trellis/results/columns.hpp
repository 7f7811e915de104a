// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of documents: an array for each column, so that each name stands once. For sources that include the JSON
// library.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace trellis::json {

/// Writes a table row by row. Stores its text, so that a column takes as much memory as it takes in the document.
class ColumnWriter {
 public:
  using Json = nlohmann::ordered_json;

  /// Appends a row. A member of an object becomes a column of its own, OBJECT.MEMBER. Other values are numbers,
  /// booleans, texts, null, and lists of numbers, of texts, or of pairs of a text and a number. The values of one
  /// column that are not null are of one kind.
  void add(const Json& row);
  [[nodiscard]] std::size_t rows() const { return rows_; }
  /// Returns the table as an object with one column to a line.
  /// \param indent  of its lines
  [[nodiscard]] std::string text(const std::string& indent = "  ") const;

 private:
  enum class Kind : unsigned char { plain, text, texts, pairs, list };
  struct Column {
    std::string name;
    Kind kind = Kind::plain;
    std::size_t rows = 0;
    std::string first;   ///< the entry of the first row
    std::string values;  ///< all entries; "" while all are equal to the first
    std::map<std::string, std::size_t> numbers = {};
    std::vector<std::string> texts = {};

    void append(const std::string& entry);
    void append(const Json& value);
    /// Adds nulls until the column has so many rows.
    void extend(std::size_t to);
    std::size_t number_of(const std::string& text);
    [[nodiscard]] std::string text() const;
  };

  void add(const Json& object, const std::string& prefix);

  std::vector<Column> columns_;
  std::map<std::string, std::size_t> at_;
  std::size_t rows_ = 0;
};

/// Reads the rows of a table that ColumnWriter wrote. The table must outlive it.
class ColumnReader {
 public:
  using Json = nlohmann::ordered_json;

  /// \throws an exception of the JSON library, or Error, for another object
  explicit ColumnReader(const Json& table);
  [[nodiscard]] std::size_t rows() const { return rows_; }
  /// Returns a row as it was added; without members of objects that are null.
  [[nodiscard]] Json row(std::size_t i) const;

 private:
  struct Column {
    std::vector<std::string> path;  ///< the names of the objects and of the member
    const Json* values = nullptr;
    const Json* texts = nullptr;
    bool pairs = false;
  };
  std::vector<Column> columns_;
  std::size_t rows_ = 0;
};

}  // namespace trellis::json
