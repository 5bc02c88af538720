#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include <pliant/backend/backend.hpp>
#include <pliant/error.hpp>

// Objects as bytes: numbers as they lie in memory, lists behind their length, structures by their lists of
// members (for_each_member).
namespace pliant::detail {

struct IgnoreMember {
  void operator()(char const*, auto&...) const {}
};
template <class U>
concept HasMembers = requires(U& u) { std::remove_cv_t<U>::for_each_member(IgnoreMember{}, u); };
template <class U>
concept HasElements = requires { std::tuple_size<U>::value; };  // std::array, std::pair, std::tuple
template <class U>
concept IsPointer = requires(U const& u) {
  typename U::element_type;
  *u;
} && std::is_class_v<U>;
template <class U>
concept IsMap = requires { typename U::mapped_type; };
template <class U>
concept IsArray = requires(U const& u) { u.download({}); };

/// Appends the bytes of objects to a text.
class ByteWriter {
 public:
  explicit ByteWriter(std::string& bytes) : bytes_(bytes) {}

  template <class U>
  void operator()(char const*, U const& member) const {
    put(member);
  }
  template <class U>
  void put(U const& x) const {
    if constexpr (std::is_arithmetic_v<U> || std::is_enum_v<U>) {
      numbers(&x, 1);
    } else if constexpr (HasMembers<U const>) {
      U::for_each_member(*this, x);
    } else if constexpr (IsPointer<U>) {
      put(x != nullptr);
      if (x) put(*x);
    } else if constexpr (HasElements<U>) {
      std::apply([&](auto const&... element) { (put(element), ...); }, x);
    } else if constexpr (IsArray<U>) {
      put(download<std::remove_cvref_t<decltype(*x.data())>>(x));
    } else if constexpr (IsMap<U>) {
      std::vector<typename U::value_type const*> sorted;
      for (auto const& entry : x) sorted.push_back(&entry);
      std::ranges::sort(sorted, {}, [](auto const* entry) { return entry->first; });
      put(static_cast<std::uint64_t>(sorted.size()));
      for (auto const* entry : sorted) put(*entry);
    } else {
      put(static_cast<std::uint64_t>(x.size()));
      if constexpr (requires { requires std::is_arithmetic_v<typename U::value_type>; }) {
        numbers(x.data(), x.size());
      } else {
        for (auto const& element : x) put(element);
      }
    }
  }

 private:
  template <class U>
  void numbers(U const* first, std::size_t count) const {
    bytes_.append(reinterpret_cast<char const*>(first), count * sizeof(U));
  }
  std::string& bytes_;
};

/// Reads what ByteWriter wrote. Throws Error where bytes are missing.
template <Backend B>
class ByteReader {
 public:
  ByteReader(B const& backend, std::string_view& bytes) : backend_(backend), bytes_(bytes) {}

  template <class U>
  void operator()(char const*, U& member) const {
    get(member);
  }
  template <class U>
  void get(U& x) const {
    if constexpr (std::same_as<U, bool>) {
      x = take<unsigned char>() != 0;
    } else if constexpr (std::is_arithmetic_v<U> || std::is_enum_v<U>) {
      numbers(&x, 1);
    } else if constexpr (HasMembers<U>) {
      U::for_each_member(*this, x);
    } else if constexpr (IsPointer<U>) {
      x = nullptr;
      if (!take<bool>()) return;
      auto value = std::make_shared<std::remove_const_t<typename U::element_type>>();
      get(*value);
      x = std::move(value);
    } else if constexpr (HasElements<U>) {
      std::apply([&](auto&... element) { (get(element), ...); }, x);
    } else if constexpr (IsArray<U>) {
      using Value = std::remove_cvref_t<decltype(*x.data())>;
      auto const values = take<std::vector<Value>>();
      x = zeros<Value>(backend_, values.size());
      x.upload(values);
    } else if constexpr (IsMap<U>) {
      x.clear();
      for (auto count = length(); count > 0; --count) {
        auto key = take<typename U::key_type>();
        x.emplace(std::move(key), take<typename U::mapped_type>());
      }
    } else if constexpr (requires {
                           typename U::value_type;
                           x.clear();
                         }) {
      x.clear();
      if constexpr (std::is_arithmetic_v<typename U::value_type>) {
        auto const count = length(sizeof(typename U::value_type));
        x.resize(count);
        numbers(x.data(), count);
      } else {
        for (auto count = length(); count > 0; --count) x.push_back(take<typename U::value_type>());
      }
    } else {  // a Facet
      x = {};
      auto const count = length(sizeof(Index));
      if (count > U::capacity) refuse();
      for (std::size_t k = 0; k < count; ++k) x.push_back(take<Index>());
    }
  }
  /// Throws Error unless all bytes were read.
  void finish() const {
    if (!bytes_.empty()) refuse();
  }

 private:
  template <class U>
  U take() const {
    U x{};
    get(x);
    return x;
  }
  /// Of a list whose elements take so many bytes at the least.
  std::size_t length(std::size_t least = 1) const {
    auto const count = take<std::uint64_t>();
    if (count > bytes_.size() / least) refuse();
    return static_cast<std::size_t>(count);
  }
  template <class U>
  void numbers(U* first, std::size_t count) const {
    if (bytes_.size() / sizeof(U) < count) refuse();
    if (count > 0) std::memcpy(first, bytes_.data(), count * sizeof(U));
    bytes_.remove_prefix(count * sizeof(U));
  }
  [[noreturn]] static void refuse() {
    throw Error("body.load: the members of the state do not fill it; save it anew");
  }

  B const& backend_;
  std::string_view& bytes_;
};

}  // namespace pliant::detail
