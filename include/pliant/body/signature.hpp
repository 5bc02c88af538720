#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/checksum.hpp>
#include <pliant/body/member_bytes.hpp>
#include <pliant/body/parts.hpp>
#include <pliant/body/plain_type_name.hpp>

namespace pliant::detail {

/// Numbers to their last digit.
inline std::string exactly(std::initializer_list<double> numbers) {
  std::string text;
  for (double x : numbers) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.17g", x);
    text += (text.empty() ? "" : ", ") + std::string(digits);
  }
  return text;
}

/// What two bodies must share for one to take the other's state: names of parts, and what they are.
using Signature = std::vector<std::pair<std::string, std::string>>;

template <Backend B, class M, class... Fs>
Signature signature_of(Parts<B, M, Fs...> const& parts) {
  Signature signature;
  auto const add = [&](std::string part, std::string is) {
    signature.emplace_back(std::move(part), std::move(is));
  };
  add("scalar", plain_type_name<typename B::scalar>());
  add("dimension", message({M::dim}));
  add("mesh", plain_type_name<M>());
  int number = 0;
  auto const add_group = [&]<class F>(Group<F> const& group) {
    std::string const name = message({"group ", number++});
    add("number of points of " + name, message({F::points}));
    add("number of internal variables of " + name, message({internal_variables_of<F>}));
    add("number of values per element of " + name, message({element_values<F>}));
    std::string law = "those of the material";
    if (group.law) {
      law.clear();
      for (double p : parameters(*group.law)) law += (law.empty() ? "" : ", ") + exactly({p});
    }
    add(name, plain_type_name<F>());
    add("law's parameters of " + name, law);
  };
  std::apply([&](auto const&... group) { (add_group(group), ...); }, parts.groups);
  add("material", exactly({parts.material.young, parts.material.poisson, parts.material.density}));
  std::string bytes;
  ByteWriter(bytes).put(*parts.first);
  char digits[32];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(checksum(bytes)));
  add("first mesh", message({parts.first->nodes(), " nodes, checksum ", digits}));
  return signature;
}

/// Throws Error, and says which part, unless signatures are the same.
inline void check_signature(Signature const& theirs, Signature const& ours) {
  for (std::size_t k = 0; k < std::max(theirs.size(), ours.size()); ++k) {
    std::pair<std::string, std::string> const none{"end", ""};
    auto const& there = k < theirs.size() ? theirs[k] : none;
    auto const& here = k < ours.size() ? ours[k] : none;
    if (there != here)
      throw Error("body.load: the state is of another body: there, the ", there.first, " is \"",
                  there.second, "\"; here, the ", here.first, " is \"", here.second,
                  "\"; make the body as it was when it was saved");
  }
}

}  // namespace pliant::detail
