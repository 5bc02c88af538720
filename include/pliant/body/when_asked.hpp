#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

namespace pliant {

/// A value that is made when it is first asked for, once; copies share it. It never changes.
template <class V>
class WhenAsked {
 public:
  using element_type = V const;

  WhenAsked() = default;
  WhenAsked(std::nullptr_t) {}
  /// One that is there; null: none.
  WhenAsked(std::shared_ptr<V const> value) {
    if (value) slot_ = std::make_shared<Slot>(std::move(value));
  }
  WhenAsked(std::shared_ptr<V> value) : WhenAsked(std::shared_ptr<V const>(std::move(value))) {}
  WhenAsked(V value) : WhenAsked(std::make_shared<V const>(std::move(value))) {}
  /// `make`() gives it. Where that throws, it is called again when the value is asked for again.
  static WhenAsked by(std::function<std::shared_ptr<V const>()> make) {
    WhenAsked later;
    later.slot_ = std::make_shared<Slot>(nullptr, std::move(make));
    return later;
  }

  explicit operator bool() const { return slot_ != nullptr; }
  friend bool operator==(WhenAsked const& a, std::nullptr_t) { return a.slot_ == nullptr; }
  /// Whether both are one and the same, which makes none.
  [[nodiscard]] bool is(WhenAsked const& other) const { return slot_ == other.slot_; }
  /// What is one and the same for all that share the value.
  [[nodiscard]] std::shared_ptr<void const> handle() const { return slot_; }
  V const& operator*() const { return *shared(); }
  V const* operator->() const { return shared().get(); }
  V const* get() const { return slot_ ? shared().get() : nullptr; }
  std::shared_ptr<V const> const& shared() const {
    std::call_once(slot_->once, [&] {
      if (slot_->value) return;
      slot_->value = slot_->make();
      slot_->make = {};  // what it holds goes
    });
    return slot_->value;
  }

 private:
  struct Slot {
    explicit Slot(std::shared_ptr<V const> given, std::function<std::shared_ptr<V const>()> by = {})
        : value(std::move(given)), make(std::move(by)) {}
    std::once_flag once;
    std::shared_ptr<V const> value;
    std::function<std::shared_ptr<V const>()> make;
  };
  std::shared_ptr<Slot> slot_;
};

}  // namespace pliant
