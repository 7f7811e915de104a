// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/errors.hpp>

#include <utility>

namespace trellis {

namespace {

std::string lines_of(const std::vector<std::string>& messages) {
  std::string all;
  for (const std::string& message : shortened(messages)) all += (all.empty() ? "" : "\n") + message;
  return all;
}

}  // namespace

std::vector<std::string> shortened(std::vector<std::string> messages) {
  constexpr std::size_t most = 50;
  if (messages.size() <= most) return messages;
  const std::size_t more = messages.size() - most;
  messages.resize(most);
  messages.push_back("and " + std::to_string(more) + " more");
  return messages;
}

Errors::Errors(std::vector<std::string> messages) : Error(lines_of(messages)), messages_(std::move(messages)) {}

bool ErrorList::attempt(const std::function<void()>& read) {
  try {
    read();
    return true;
  } catch (const Error& error) {
    add(error);
    return false;
  }
}

void ErrorList::add(const Error& error) {
  const auto* several = dynamic_cast<const Errors*>(&error);
  std::vector<std::string> messages = several != nullptr ? several->messages() : std::vector<std::string>{error.what()};
  for (std::string& message : messages) {
    if (there_.insert(message).second) messages_.push_back(std::move(message));
  }
}

void ErrorList::raise() const {
  if (messages_.size() == 1) throw Error(messages_.front());
  if (!messages_.empty()) throw Errors(messages_);
}

}  // namespace trellis
