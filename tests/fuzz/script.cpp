// SPDX-License-Identifier: GPL-3.0-or-later
// Scripts: loads them, checks each strategy on the first problem, and runs a few proposals of it. The mutations know
// the language: they insert words of the registry and set options to values at and beyond the ends of their ranges.
#include <algorithm>
#include <cctype>
#include <vector>

#include <dsl/language/tools/session.hpp>
#include <dsl/language/tools/words.hpp>
#include <trellis/strategy/executor.hpp>

#include "fuzz.hpp"

namespace {

using trellis::Option;
using trellis::dsl::Word;
using trellis::fuzz::any_of;
using trellis::fuzz::extreme_number;

constexpr int most_polls = 300;

std::string value_for(const Option& option, std::mt19937_64& random) {
  if (!option.choices.empty() && random() % 2 == 0) return '"' + any_of(option.choices, random) + '"';
  switch (random() % 8) {
    case 0: return "true";
    case 1: return "{}";
    case 2: return "\"\"";
    case 3: return "nil";
    default: return extreme_number(random);
  }
}

/// Returns a word of the language with some of its options.
std::string expression(std::mt19937_64& random) {
  const Word& word = any_of(trellis::dsl::words(), random);
  std::string text = word.name + " {";
  for (std::size_t i = random() % 3; i > 0 && !word.options.empty(); --i) {
    const Option& option = any_of(word.options, random);
    text += " " + option.name + " = " + value_for(option, random) + ",";
  }
  return text + " }";
}

/// Begins and ends of the words of a text.
std::vector<std::pair<std::size_t, std::size_t>> words_in(const std::string& text) {
  std::vector<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t i = 0; i < text.size();) {
    const auto part = [&](std::size_t at) {
      return std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_' || text[at] == '.';
    };
    std::size_t end = i;
    while (end < text.size() && part(end)) ++end;
    if (end > i) found.emplace_back(i, end);
    i = std::max(end, i + 1);
  }
  return found;
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  return trellis::fuzz::examine([&] {
    trellis::dsl::Session session(
        "", {.memory = std::size_t{64} << 20U, .print = [](const std::string&) {}, .instructions = 2'000'000});
    const trellis::Experiment experiment = session.load(text, "fuzz.lua").experiment;
    const trellis::Problem& problem = experiment.problems.front();
    for (std::size_t i = 0; i < std::min<std::size_t>(experiment.strategies.size(), 3); ++i) {
      const trellis::StrategySpec& strategy = experiment.strategies[i].second;
      trellis::fuzz::examine([&] {
        trellis::check(strategy, problem);
        int polls = 0;
        static_cast<void>(
            trellis::execute(strategy, problem, 1, {.interrupted = [&] { return ++polls > most_polls; }}));
      });
    }
  });
}

std::string trellis::fuzz::mutated(const std::string& input, std::mt19937_64& random) {
  std::string text = input;
  for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
    const auto found = words_in(text);
    if (found.empty() || random() % 4 == 0) {
      text = mutated_text(std::move(text), random);
      continue;
    }
    const auto [begin, end] = any_of(found, random);
    const bool number = std::isdigit(static_cast<unsigned char>(text[begin])) != 0;
    if (number) {
      text.replace(begin, end - begin, extreme_number(random));
    } else if (random() % 2 == 0) {
      text.replace(begin, end - begin, any_of(dsl::words(), random).name);
    } else {
      text.insert(begin, expression(random) + (random() % 2 == 0 ? " >> " : ", "));
    }
  }
  return text;
}
