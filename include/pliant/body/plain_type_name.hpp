#pragma once

#include <string>
#include <string_view>

namespace pliant::detail {

/// The name of a type without namespaces and blanks, which compilers write differently.
template <class U>
std::string plain_type_name() {
  std::string_view name =
      __PRETTY_FUNCTION__;  // ...[with U = NAME; std::string = ...] or [U = NAME]
  name.remove_prefix(name.find("U = ") + 4);
  name = name.substr(0, name.find(';'));
  if (name.ends_with(']')) name.remove_suffix(1);
  std::string plain;
  std::size_t word = 0;  // where the present one begins
  for (std::size_t i = 0; i < name.size(); ++i) {
    char const c = name[i];
    if (c == ':' && i + 1 < name.size() && name[i + 1] == ':') {
      if (plain.size() > word)
        plain.resize(word);
      else if (plain.ends_with('}') || plain.ends_with(')'))
        plain.resize(plain.find_last_of("{("));
      else
        plain += "::";
      ++i;
      word = plain.size();
    } else if (c != ' ') {
      plain += c;
      bool const letter =
          c == '_' || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
      if (!letter) word = plain.size();
    }
  }
  return plain;
}

}  // namespace pliant::detail
