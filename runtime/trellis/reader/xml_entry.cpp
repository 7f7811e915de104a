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
  const auto document = std::make_shared<Document>();
  tinyxml2::XMLDocument& xml = document->xml;
  if (xml.Parse(all.data(), all.size()) != tinyxml2::XML_SUCCESS) {
    throw text.error(static_cast<std::size_t>(std::max(xml.ErrorLineNum(), 1)),
                     fmt::format("no XML that can be read: {}", xml_fault(xml)));
  }
  const tinyxml2::XMLElement* element = xml.RootElement();
  if (element == nullptr || (!root.empty() && element->Name() != root)) {
    throw text.error(1, fmt::format("the outermost element is no '{}'", root));
  }
  document->used.insert(element);
  return {text, document, *element};
}

std::size_t XmlEntry::line() const { return static_cast<std::size_t>(std::max(element_->GetLineNum(), 1)); }

Error XmlEntry::error(const std::string& fault) const { return text_->error(line(), fault); }

std::vector<XmlEntry> XmlEntry::children(std::string_view name) const {
  document_->used.insert(element_);
  std::vector<XmlEntry> all;
  for (const auto* one = element_->FirstChildElement(); one != nullptr; one = one->NextSiblingElement()) {
    if (!name.empty() && one->Name() != name) continue;
    if (!name.empty()) document_->used.insert(one);
    all.push_back({*text_, document_, *one});
  }
  return all;
}

std::optional<XmlEntry> XmlEntry::child(std::string_view name) const {
  document_->used.insert(element_);
  for (const auto* one = element_->FirstChildElement(); one != nullptr; one = one->NextSiblingElement()) {
    if (one->Name() != name) continue;
    document_->used.insert(one);
    return XmlEntry(*text_, document_, *one);
  }
  return std::nullopt;
}

XmlEntry XmlEntry::required(std::string_view name) const {
  if (auto found = child(name)) return *found;
  throw error(fmt::format("'{}' lacks '{}'", this->name(), name));
}

const char* XmlEntry::value(const char* attribute) const {
  document_->used.insert(element_);
  const tinyxml2::XMLAttribute* found = element_->FindAttribute(attribute);
  if (found == nullptr) return nullptr;
  document_->used.insert(found);
  return found->Value();
}

std::string XmlEntry::word(const char* attribute) const {
  const char* text = value(attribute);
  if (text == nullptr || *text == '\0') throw error(fmt::format("'{}' lacks '{}'", name(), attribute));
  return text;
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

void XmlEntry::skip(std::initializer_list<std::string_view> names) const {
  const auto known = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  for (const auto* one = element_->FirstChildElement(); one != nullptr; one = one->NextSiblingElement()) {
    if (known(one->Name())) document_->skipped.insert(one);
  }
  for (const auto* one = element_->FirstAttribute(); one != nullptr; one = one->Next()) {
    if (known(one->Name())) document_->skipped.insert(one);
  }
}

std::vector<Unused> XmlEntry::unused() const {
  std::vector<Unused> entries;
  add_unused(entries);
  return entries;
}

void XmlEntry::add_unused(std::vector<Unused>& entries) const {
  const auto known = [&](const void* part) { return document_->used.contains(part); };
  if (document_->skipped.contains(element_)) return;
  if (!known(element_)) {
    entries.push_back({name(), line()});
    return;
  }
  for (const auto* one = element_->FirstAttribute(); one != nullptr; one = one->Next()) {
    // Declarations of namespaces say nothing of the element.
    if (known(one) || document_->skipped.contains(one) || std::string_view(one->Name()).starts_with("xml")) continue;
    entries.push_back({fmt::format("{}' of '{}", one->Name(), name()), line()});
  }
  for (const XmlEntry& child : children()) child.add_unused(entries);
}

std::optional<XmlEntry> XmlEntry::find(const std::function<bool(std::string_view)>& name,
                                       const std::function<bool(std::string_view)>& value) const {
  const tinyxml2::XMLElement* at = element_;
  while (at != nullptr) {
    bool found = name(at->Name());
    for (const auto* one = at->FirstAttribute(); !found && one != nullptr; one = one->Next()) {
      found = value(one->Value());
    }
    if (found) return XmlEntry(*text_, document_, *at);
    const tinyxml2::XMLElement* next = at->FirstChildElement();
    // Up to the first element with another one after it.
    while (next == nullptr && at != element_) {
      next = at->NextSiblingElement();
      if (next == nullptr) at = at->Parent()->ToElement();
    }
    at = next;
  }
  return std::nullopt;
}

}  // namespace trellis
