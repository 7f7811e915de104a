// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/xml_entry.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

namespace trellis {

std::string xml_fault(const tinyxml2::XMLDocument& document) {
  std::string text = document.ErrorName();
  for (const std::string prefix : {"XML_", "ERROR_"}) {
    if (text.starts_with(prefix)) text.erase(0, prefix.size());
  }
  std::replace(text.begin(), text.end(), '_', ' ');
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

XmlEntry XmlEntry::root(const SourceText& text, std::string_view root) {
  const std::string all = text.joined();
  const auto document = std::make_shared<tinyxml2::XMLDocument>();
  if (document->Parse(all.data(), all.size()) != tinyxml2::XML_SUCCESS) {
    throw text.error(static_cast<std::size_t>(std::max(document->ErrorLineNum(), 1)),
                     fmt::format("no XML that can be read: {}", xml_fault(*document)));
  }
  const tinyxml2::XMLElement* element = document->RootElement();
  if (element == nullptr || element->Name() != root) {
    throw text.error(1, fmt::format("the outermost element is no '{}'", root));
  }
  return {text, document, *element};
}

std::size_t XmlEntry::line() const { return static_cast<std::size_t>(std::max(element_->GetLineNum(), 1)); }

Error XmlEntry::error(const std::string& fault) const { return text_->error(line(), fault); }

std::vector<XmlEntry> XmlEntry::children(std::string_view name) const {
  std::vector<XmlEntry> all;
  for (const auto* one = element_->FirstChildElement(); one != nullptr; one = one->NextSiblingElement()) {
    if (name.empty() || one->Name() == name) all.push_back({*text_, document_, *one});
  }
  return all;
}

std::optional<XmlEntry> XmlEntry::child(std::string_view name) const {
  for (const auto* one = element_->FirstChildElement(); one != nullptr; one = one->NextSiblingElement()) {
    if (one->Name() == name) return XmlEntry(*text_, document_, *one);
  }
  return std::nullopt;
}

XmlEntry XmlEntry::required(std::string_view name) const {
  if (auto found = child(name)) return *found;
  throw error(fmt::format("'{}' lacks '{}'", this->name(), name));
}

std::string XmlEntry::word(const char* attribute) const {
  const char* value = element_->Attribute(attribute);
  if (value == nullptr || *value == '\0') throw error(fmt::format("'{}' lacks '{}'", name(), attribute));
  return value;
}

std::vector<double> XmlEntry::numbers(const char* attribute) const {
  std::vector<double> all;
  for (const std::string& word : words_of(word(attribute))) {
    double value = 0.0;
    const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
    const char* const last = word.data() + word.size();
    const auto [end, fault] = std::from_chars(begin, last, value);
    if (fault != std::errc() || end != last || !std::isfinite(value)) {
      throw error(fmt::format("'{}' of '{}' is '{}', expected a finite number", attribute, name(), word));
    }
    all.push_back(value);
  }
  return all;
}

double XmlEntry::number(const char* attribute) const {
  const std::vector<double> all = numbers(attribute);
  if (all.size() != 1) {
    throw error(fmt::format("'{}' of '{}' is '{}', expected one number", attribute, name(), word(attribute)));
  }
  return all.front();
}

double XmlEntry::number(const char* attribute, double otherwise) const {
  return has(attribute) ? number(attribute) : otherwise;
}

std::array<double, 3> XmlEntry::triple(const char* attribute, const std::array<double, 3>& otherwise) const {
  if (!has(attribute)) return otherwise;
  const std::vector<double> all = numbers(attribute);
  if (all.size() != 3) {
    throw error(fmt::format("'{}' of '{}' is '{}', expected three numbers", attribute, name(), word(attribute)));
  }
  return {all[0], all[1], all[2]};
}

}  // namespace trellis
