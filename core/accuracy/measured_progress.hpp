#pragma once
/// How far a measurement of several steps is.
#include <algorithm>
#include <functional>
#include <string>

namespace voxtouch::accuracy {

/// Steps have weights, which are rough seconds; what they add up to is known before the first.
class MeasuredProgress {
 public:
  using Tell = std::function<void(const std::string& what, double share)>;

  MeasuredProgress(double all_weights, Tell tell) : all_(all_weights), tell_(std::move(tell)) {}

  /// The step before has ended.
  void begin(std::string what, double weight) {
    done_ += weight_;
    what_ = std::move(what), weight_ = weight;
    at(0.0);
  }
  /// `share` of the present step is done.
  void at(double share) const {
    if (tell_) tell_(what_, std::clamp((done_ + share * weight_) / all_, 0.0, 1.0));
  }

 private:
  double all_, done_ = 0.0, weight_ = 0.0;
  std::string what_;
  Tell tell_;
};

}  // namespace voxtouch::accuracy
