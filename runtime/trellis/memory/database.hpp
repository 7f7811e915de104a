// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace trellis {

/// A file of SQLite. One source includes SQLite's header. Errors name the file; `Names` says what the file is.
class Database {
 public:
  struct Names {
    const char* kind;   ///< "library of paths"
    const char* brief;  ///< "library"
  };
  enum class Mode : std::uint8_t {
    read,   ///< an existing file
    write,  ///< created if necessary; a commit is on the disk when it returns
  };

  /// \throws Error for a file that is no database, not even an empty one; leaves it as it is
  Database(std::string path, Mode mode, Names names);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// A prepared statement. Parameters and columns: ?1 is place 1, the first column is 0.
  class Statement {
   public:
    Statement(const Database& database, std::string_view text);
    ~Statement();
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    /// Steps to the next row; false after the last.
    bool step();
    /// Makes the statement ready for another execution; all parameters are NULL again.
    void reset();
    void bind(int place, const std::string& text);
    void bind_blob(int place, const std::string& bytes);
    void bind(int place, std::int64_t value);
    void bind(int place, double value);

    [[nodiscard]] std::int64_t integer(int column) const;
    [[nodiscard]] double number(int column) const;
    [[nodiscard]] std::string bytes(int column) const;

   private:
    void check(int code) const;
    const Database& database_;
    sqlite3_stmt* statement_ = nullptr;
  };

  /// Runs statements without results.
  void run(const char* text) const;
  /// Returns the first integer of the first row; 0 without a row.
  [[nodiscard]] std::int64_t ask(const char* text) const;

  /// Runs `body` in a transaction: its queries see one state of the file; an exception rolls it back.
  template <class Body>
  void together(const char* begin, const Body& body) const {
    run(begin);
    try {
      body();
      run("COMMIT");
    } catch (...) {
      // If the rollback fails too, closing or reopening the file rolls back.
      roll_back();
      throw;
    }
  }

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  [[noreturn]] void fail(const char* what) const;
  void open(Mode mode);
  void check_header() const;
  void roll_back() const;

  std::string path_;
  Names names_;
  sqlite3* handle_ = nullptr;
};

}  // namespace trellis
