// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/words/publication.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;
using Claim = Publication::Claim;

/// A name or a list of names.
std::vector<std::string> read_names(const Arguments& arguments, const std::string& field) {
  const Value value = arguments[field];
  if (const auto one = value.string()) return {*one};
  if (value.type() != Type::table) arguments.reject(field);
  const lua::Keys keys = value.keys();
  if (!keys.names.empty() || !keys.odd.empty() || keys.length == 0) arguments.reject(field);
  std::vector<std::string> names;
  value.each([&](std::size_t, Value element) {
    const auto name = element.string();
    if (!name) arguments.reject(field);
    names.push_back(*name);
  });
  return names;
}

int make_claim(Stack& call) {
  const Arguments arguments(claim_construct(), call);
  Claim claim;
  arguments.each([&](std::size_t i, Value element) {
    const auto text = element.string();
    if (!text || i > 1) throw Error(fmt::format("claim: takes one sentence, got {}", describe(element)));
    claim.text = *text;
  });
  if (claim.text.empty()) throw Error(R"(claim: the sentence is missing, as claim { "a does better than b", ... })");
  claim.problem = arguments.string("problem").value_or("");
  claim.strategy = arguments.string("strategy").value_or("");
  const bool lower = arguments["lower_than"].given();
  if (lower == arguments["not_lower_than"].given()) {
    throw Error("claim: needs one of the fields 'lower_than' and 'not_lower_than', and not both");
  }
  claim.lower = lower;
  claim.than = read_names(arguments, lower ? "lower_than" : "not_lower_than");
  claim.roles = {Claim::Role::tree};
  if (arguments["roles"].given()) {
    claim.roles.clear();
    for (const std::string& role : read_names(arguments, "roles")) {
      if (role != "tree" && role != "expansion") arguments.reject("roles");
      claim.roles.push_back(role == "tree" ? Claim::Role::tree : Claim::Role::expansion);
    }
  }
  return call.result(std::move(claim));
}

/// { PROBLEM = { STRATEGY = {tree, expansion}, ... }, ... }
std::vector<Publication::Entry> read_figures(const Arguments& arguments) {
  const Value problems = arguments["figures"];
  if (problems.type() != Type::table) arguments.reject("figures");
  const auto names_of = [&](Value table) {
    const lua::Keys keys = table.keys();
    if (keys.length > 0 || !keys.odd.empty()) arguments.reject("figures");
    return keys.names;
  };
  std::vector<Publication::Entry> entries;
  for (const std::string& problem : names_of(problems)) {
    const Value strategies = problems.field(problem);
    if (strategies.type() != Type::table) arguments.reject("figures");
    for (const std::string& strategy : names_of(strategies)) {
      const std::string what = fmt::format("published: field 'figures', {}, {}", problem, strategy);
      const std::vector<double> figures = read_numbers(strategies.field(strategy), what);
      if (figures.empty() || figures.size() > 2) {
        throw Error(fmt::format("{} must hold the figure of the tree and perhaps that of the expansion, got {} numbers",
                                what, figures.size()));
      }
      Publication::Entry entry;
      entry.problem = problem;
      entry.strategy = strategy;
      entry.tree = figures[0];
      if (figures.size() > 1) entry.expansion = figures[1];
      entries.push_back(std::move(entry));
    }
  }
  return entries;
}

int make_publication(Stack& call) {
  const Arguments arguments(published_construct(), call);
  Publication published;
  published.source = arguments.string("source").value_or("");
  published.entries = read_figures(arguments);
  const Value claims = arguments["claims"];
  if (!claims.given()) return call.result(std::move(published));
  if (claims.type() != Type::table) arguments.reject("claims");
  const lua::Keys keys = claims.keys();
  if (!keys.names.empty() || !keys.odd.empty()) arguments.reject("claims");
  claims.each([&](std::size_t, Value element) {
    const auto* claim = element.get<Claim>();
    if (claim == nullptr) arguments.reject("claims");
    published.claims.push_back(*claim);
  });
  return call.result(std::move(published));
}

int publication_text(Stack& call) {
  const auto* published = call[1].get<Publication>();
  if (published == nullptr) return call.result(call[1].describe());
  return call.result(fmt::format("{} figures and {} claims of {}", published->entries.size(), published->claims.size(),
                                 published->source));
}

int claim_text(Stack& call) {
  const auto* claim = call[1].get<Claim>();
  return call.result(claim == nullptr ? call[1].describe() : "claim: " + claim->text);
}

}  // namespace

const Construct& claim_construct() {
  static const Construct construct = {
      .name = "claim",
      .usage = R"(claim { "b does better", problem = "trap", strategy = "b", lower_than = {"a"} })",
      .summary = "a sentence that the results are to bear out",
      .list = "the sentence",
      .element = "string",
      .fields = {{"problem", "string", "the name of a problem", "where it is said to hold", true},
                 {"strategy", "string", "the name of a strategy", "whose sampling efficiency it speaks of", true},
                 {"lower_than", "string|string[]", "the name of a strategy, or a list of names",
                  "it holds where the efficiency is lower (better) than that of each; no doubt is left where the 95 % "
                  "interval of the difference, paired by seed, lies on one side of 0"},
                 {"not_lower_than", "string|string[]", "the name of a strategy, or a list of names",
                  "it holds where the efficiency is not lower: similar or worse"},
                 {"roles", "string|string[]", R"("tree", "expansion", or a list of both)", "whose samples", false,
                  R"("tree")"}},
      .options = {},
      .returns = "trellis.Claim"};
  return construct;
}

const Construct& published_construct() {
  static const Construct construct = {
      .name = "published",
      .usage = R"(published { source = "...", figures = { trap = { rrt = {9.6, 7.5} } } })",
      .summary = "published figures and sentences, to compare the results with",
      .list = "",
      .element = "",
      .fields = {{"source", "string", "a string", "a citation", true},
                 {"figures", "table<string, table<string, number[]>>",
                  "a table { PROBLEM = { STRATEGY = {tree, expansion} } }",
                  "sampling efficiencies of the root, in nats; the expansion's may be left out", true},
                 {"claims", "trellis.Claim[]", "a list of claims, as claim { ... }",
                  "the sentences that were concluded"}},
      .options = {},
      .returns = "trellis.Publication"};
  return construct;
}

void open_publication(Stack& stack) {
  stack.declare<Claim>({{"__tostring", claim_text}});
  stack.declare<Publication>({{"__tostring", publication_text}});
  stack.push_function(make_claim);
  stack.set_global(claim_construct().name);
  stack.push_function(make_publication);
  stack.set_global(published_construct().name);
}

}  // namespace trellis::dsl
