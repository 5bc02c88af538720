#pragma once

#include <array>
#include <concepts>
#include <cstdio>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include <pliant/config.hpp>

namespace pliant {

namespace detail {

/// A piece of a message: a text or a point, which must outlive it, or a number.
class MessagePiece {
 public:
  MessagePiece(char const* text) : kind_(Kind::text), text_(text) {}
  MessagePiece(std::string const& text) : MessagePiece(text.c_str()) {}
  MessagePiece(std::integral auto number)
      : kind_(Kind::whole), whole_(static_cast<long long>(number)) {}
  MessagePiece(std::floating_point auto number)
      : kind_(Kind::real), real_(static_cast<double>(number)) {}
  template <std::size_t Dim>
  MessagePiece(std::array<double, Dim> const& point)
      : kind_(Kind::point), size_(Dim), point_(point.data()) {}

  void add_to(std::string& message) const {
    char digits[32];
    char const* text = digits;
    if (kind_ == Kind::text) text = text_;
    if (kind_ == Kind::whole) std::snprintf(digits, sizeof digits, "%lld", whole_);
    if (kind_ == Kind::real) std::snprintf(digits, sizeof digits, "%g", real_);
    if (kind_ != Kind::point) {
      message.append(text);
      return;
    }
    for (std::size_t k = 0; k < size_; ++k) {
      message.append(k ? ", " : "(");
      MessagePiece(point_[k]).add_to(message);
    }
    message.append(")");
  }

 private:
  enum class Kind { text, whole, real, point } kind_;
  std::size_t size_ = 0;
  union {
    char const* text_;
    long long whole_;
    double real_;
    double const* point_;
  };
};

/// The pieces one behind the other. Out of line, since messages are made in many places and seldom.
[[gnu::cold, gnu::noinline]] inline std::string message(
    std::initializer_list<MessagePiece> pieces) {
  std::string all;
  for (MessagePiece const& piece : pieces) piece.add_to(all);
  return all;
}

}  // namespace detail

/// The one exception of the library, made from texts and numbers: Error("node ", 7, " is not there").
/// Its message says what was wrong, where, and what to do; the object that was being changed stays as
/// it was.
struct Error : std::runtime_error {
  template <class... Pieces>
  explicit Error(Pieces const&... pieces) : Error(List{pieces...}) {}

 private:
  using List = std::initializer_list<detail::MessagePiece>;
  [[gnu::cold, gnu::noinline]] explicit Error(List pieces)
      : std::runtime_error(detail::message(pieces)) {}
};

}  // namespace pliant
