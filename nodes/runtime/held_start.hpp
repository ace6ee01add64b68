#pragma once
/// A node that `voxtouch up` starts ahead of time, while it still looks whether the rig is free: it
/// reads and builds what it needs, and joins the rig when it is told to. Until then nobody in the
/// rig hears of it.
#include <atomic>
#include <cstdint>

namespace voxtouch::runtime {

enum class Word : std::uint8_t {
  kNone,   ///< nothing was said yet
  kBegin,  ///< it may join
  kLeave,  ///< whoever started it has gone, or has given up
};

/// From now on this process is held: what it may do it hears on its standard input.
void be_held() noexcept;
/// Whether it was: whoever started it looks for others in the rig. For one thread, as the next one.
bool was_held() noexcept;
/// What was said so far; kBegin where this process is not held. Does not wait. For one thread.
Word word_of_starter() noexcept;
/// Waits for the word. False where it is to leave, or `stop` is set: it goes without a sentence,
/// for it has done nothing.
bool may_begin(const std::atomic<bool>& stop) noexcept;

/// The other end: what a held process has as its standard input.
class Starter {
 public:
  Starter() noexcept = default;
  /// Throws std::runtime_error where there is no pipe left.
  static Starter make();
  Starter(Starter&& other) noexcept;
  Starter& operator=(Starter&&) = delete;
  ~Starter();  ///< without `let_begin`: the process leaves

  /// For the child, until it has been started; -1 where there is none.
  int input() const noexcept { return input_; }
  void close_input() noexcept;
  /// Once is enough. One that has ended meanwhile does not hear it.
  void let_begin() noexcept;

 private:
  int input_ = -1, output_ = -1;
};

}  // namespace voxtouch::runtime
