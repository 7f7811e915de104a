// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tinyxml2.h>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/reader/formats.hpp>

namespace trellis {

/// Returns what tinyxml2 calls the fault of a document, in words: "mismatched element".
std::string xml_fault(const tinyxml2::XMLDocument& document);

/// An element of an XML file, with the file's name for messages, each of which gives the line. The file's text outlives
/// it; the elements of a file share its document.
class XmlEntry {
 public:
  /// \param root  name of the outermost element
  /// \throws Error where the text is no XML, or has another outermost element
  static XmlEntry root(const SourceText& text, std::string_view root);

  [[nodiscard]] Error error(const std::string& fault) const;
  [[nodiscard]] std::string name() const { return element_->Name(); }
  [[nodiscard]] std::size_t line() const;
  /// The elements within it, with this name or all.
  [[nodiscard]] std::vector<XmlEntry> children(std::string_view name = {}) const;
  /// The first of them; none without one.
  [[nodiscard]] std::optional<XmlEntry> child(std::string_view name) const;
  /// \throws Error without one
  [[nodiscard]] XmlEntry required(std::string_view name) const;
  [[nodiscard]] bool has(const char* attribute) const { return element_->Attribute(attribute) != nullptr; }
  /// The value of an attribute. \throws Error where it is missing or empty
  [[nodiscard]] std::string word(const char* attribute) const;
  /// \throws Error where it is missing or no finite number
  [[nodiscard]] double number(const char* attribute) const;
  [[nodiscard]] double number(const char* attribute, double otherwise) const;
  /// Three numbers with blanks between them.
  [[nodiscard]] std::array<double, 3> triple(const char* attribute, const std::array<double, 3>& otherwise) const;

 private:
  XmlEntry(const SourceText& text, std::shared_ptr<tinyxml2::XMLDocument> document, const tinyxml2::XMLElement& element)
      : text_(&text), document_(std::move(document)), element_(&element) {}
  [[nodiscard]] std::vector<double> numbers(const char* attribute) const;

  const SourceText* text_;
  std::shared_ptr<tinyxml2::XMLDocument> document_;
  const tinyxml2::XMLElement* element_;
};

}  // namespace trellis
