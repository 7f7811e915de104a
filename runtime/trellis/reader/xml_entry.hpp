// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tinyxml2.h>

#include <array>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/unused.hpp>

namespace trellis {

/// Returns what tinyxml2 calls the fault of a document, in words: "mismatched element".
std::string xml_fault(const tinyxml2::XMLDocument& document);

/// An element of an XML file, with the file's name for messages, each of which gives the line. The file's text outlives
/// it; the elements of a file share its document. The document records which elements and attributes its reader used:
/// an element is used where the reader names it, or asks it for a child or an attribute; an attribute where the reader
/// names it.
class XmlEntry {
 public:
  /// \param root  name of the outermost element; "" for any
  /// \throws Error where the text is no XML, or has another outermost element
  static XmlEntry root(const SourceText& text, std::string_view root);

  [[nodiscard]] Error error(const std::string& fault) const;
  [[nodiscard]] std::string name() const { return element_->Name(); }
  [[nodiscard]] std::size_t line() const;
  /// The elements within it with this name, which it marks as used; "" for all, which it does not mark.
  [[nodiscard]] std::vector<XmlEntry> children(std::string_view name = {}) const;
  /// The first of them; none without one.
  [[nodiscard]] std::optional<XmlEntry> child(std::string_view name) const;
  /// \throws Error without one
  [[nodiscard]] XmlEntry required(std::string_view name) const;
  [[nodiscard]] bool has(const char* attribute) const { return value(attribute) != nullptr; }
  /// The value of an attribute. \throws Error where it is missing or empty
  [[nodiscard]] std::string word(const char* attribute) const;
  /// \throws Error where it is missing or no finite number
  [[nodiscard]] double number(const char* attribute) const;
  [[nodiscard]] double number(const char* attribute, double otherwise) const;
  /// Numbers with blanks between them. \throws Error where it is missing or one is no finite number
  [[nodiscard]] std::vector<double> numbers(const char* attribute) const;
  /// Three numbers with blanks between them.
  [[nodiscard]] std::array<double, 3> triple(const char* attribute, const std::array<double, 3>& otherwise) const;

  /// Marks its children and attributes with these names, and all within them, as known and not needed.
  void skip(std::initializer_list<std::string_view> names) const;
  /// Marks it and all within it as known.
  void skip_inside() const { document_->skipped.insert(element_); }
  /// Returns the elements and attributes within it that were neither used nor skipped, in the order of the file;
  /// within an element that was not used, nothing more.
  [[nodiscard]] std::vector<Unused> unused() const;
  /// Returns the first element, of it and those within it, that has a name or a value of an attribute of some kind;
  /// none without one. Marks nothing.
  [[nodiscard]] std::optional<XmlEntry> find(const std::function<bool(std::string_view)>& name,
                                             const std::function<bool(std::string_view)>& value) const;

 private:
  struct Document {
    tinyxml2::XMLDocument xml;
    std::unordered_set<const void*> used;     ///< elements and attributes
    std::unordered_set<const void*> skipped;  ///< elements with all within them, and attributes
  };

  XmlEntry(const SourceText& text, std::shared_ptr<Document> document, const tinyxml2::XMLElement& element)
      : text_(&text), document_(std::move(document)), element_(&element) {}
  /// The value of an attribute, null without; marks it and the element as used.
  [[nodiscard]] const char* value(const char* attribute) const;
  void add_unused(std::vector<Unused>& entries) const;

  const SourceText* text_;
  std::shared_ptr<Document> document_;
  const tinyxml2::XMLElement* element_;
};

}  // namespace trellis
