#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include <pliant/adaptation/rule.hpp>
#include <pliant/body/checksum.hpp>
#include <pliant/body/looker.hpp>
#include <pliant/body/plain_type_name.hpp>

// Which of a body's last looks is an Adaptation's: files keep them, so that numbers are the same in each process.
namespace pliant::detail {

template <class U>
void add_bytes(std::string& text, U value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  text.append(bytes, sizeof value);
}

template <class TheRule>
void name_marking(std::string& text, TheRule const& rule) {
  Marking const& marking = rule.marking;
  add_bytes(text, static_cast<std::int64_t>(marking.kind));
  add_bytes(text, marking.amount);
  add_bytes(text, marking.floor);
  add_bytes(text, marking.budget);
  if constexpr (SwitchingRule<TheRule>) add_bytes(text, std::int64_t{rule.stay});
  if constexpr (RefiningRule<TheRule>) add_bytes(text, std::int64_t{rule.options.max_level});
  if constexpr (CoarseningRule<TheRule>) add_bytes(text, std::int64_t{rule.options.min_level});
  if constexpr (RaisingRule<TheRule>) add_bytes(text, std::int64_t{rule.options.ring});
  if constexpr (SplittingRule<TheRule>) add_bytes(text, std::int64_t{rule.options.triangles});
}
template <class TheRule>
void name_choice(std::string& text, TheRule const& rule) {
  std::array const limits{rule.tolerance, rule.error, rule.evaluations_per_step,
                          rule.milliseconds_per_step, rule.release};
  for (double limit : limits) add_bytes(text, limit);
  add_bytes(text, rule.stay);
  for (double cost : rule.costs) add_bytes(text, cost);
}
template <class TheRule>
void name_rule(std::string& text, TheRule const& rule) {
  text += plain_type_name<TheRule>();
  if constexpr (ChoosingRule<TheRule>) {
    name_choice(text, rule);
  } else if constexpr (SleepingRule<TheRule>) {
    add_bytes(text, rule.below);
    add_bytes(text, rule.for_steps);
  } else if constexpr (HoldingRule<TheRule>) {
    auto const& options = rule.options;
    add_bytes(text,
              options.error);  // one by one: nvcc 13 does not hand on a loop over a list of them
    add_bytes(text, options.evaluations_per_step);
    add_bytes(text, options.release);
    add_bytes(text, std::int64_t{options.max_level});
  } else {
    name_marking(text, rule);
  }
}

/// Tells rules of other types or numbers apart, the data of criteria aside: they may hold bytes without a value.
template <class... Rules>
std::uint64_t rules_key(Rules const&... rules) {
  std::string text;
  (name_rule(text, rules), ...);
  return checksum(text);
}

/// The one of an Adaptation that has a number.
inline Looker& looker_of(std::vector<Looker>& lookers,
                         std::shared_ptr<void const> const& adaptation) {
  return *std::ranges::find_if(
      lookers, [&](Looker const& looker) { return looker.adaptation.lock() == adaptation; });
}

/// The number of an Adaptation's last look. Of those with the same key, each has its own, in the order in which
/// they first looked at the body; one that is gone leaves its to the next that comes.
inline std::uint64_t look_key(std::vector<Looker>& lookers, std::uint64_t rules,
                              std::shared_ptr<void const> const& adaptation) {
  std::uint64_t before = 0;
  Looker* free = nullptr;
  std::uint64_t number_of_free = 0;
  for (Looker& looker : lookers) {
    if (looker.rules != rules) continue;
    auto const other = looker.adaptation.lock();
    if (other == adaptation) return rules + before;
    if (!other && free == nullptr) {
      free = &looker;
      number_of_free = before;
    }
    ++before;
  }
  if (free != nullptr) {
    free->adaptation = adaptation;
    return rules + number_of_free;
  }
  lookers.push_back({rules, adaptation});
  return rules + before;
}

}  // namespace pliant::detail
