#pragma once
/// The coupling of a recorded run once more: what was designed, from which sample on, and each
/// contact through it.
#include <deque>
#include <string>
#include <vector>

#include "core/fitting/fit_coupling.hpp"
#include "nodes/coupling/contact_coupling.hpp"
#include "nodes/replay/recording.hpp"

namespace voxtouch::replay {

/// In lockstep a new design holds from the sample on whose plan called for it. In real time it is
/// made beside the loop, and the bag says when it was told, not from which sample on it holds. The
/// commands do: for each sample at which it may have begun a coupling goes on that did, and those
/// stay whose commands are the recorded ones, to the bit.
class CouplingReplay {
 public:
  /// `search`: look for the sample in the commands; else a design holds from the sample that called
  /// for it.
  CouplingReplay(const scene::Scene& scene, bool search)
      : scene_(scene),
        search_(search),
        free_(scene.device) {}

  /// `session` outlives it, or lives up to the next one's beginning.
  void begin_session(const RecordedSession& session, const rendering::StiffnessBounds& bounds,
                     const fitting::DeviceDemand& demand);
  /// What the plan says from the contact `from_sample` on.
  void contact_shows(std::uint64_t from_sample, const rendering::StiffnessBounds& bounds,
                     const fitting::DeviceDemand& demand);
  bool runs() const noexcept { return !candidates_.empty(); }
  /// Only while it runs. `recorded`: the sample's command, taken by the recorder at `taken_ns`.
  msg::ForceCommand answer(const msg::ContactState& contact, const msg::ForceCommand& recorded,
                           std::int64_t taken_ns);
  /// What was found out, and what could not be, a sentence each.
  const std::vector<std::string>& notes() const noexcept { return notes_; }

 private:
  struct Candidate {
    coupling_node::ContactCoupling coupling;
    std::uint64_t began = 0;  ///< sample from which the newest design runs in it; 0: not yet
  };
  struct Wanted {
    std::uint64_t from_sample = 0;
    fitting::FittedCoupling fitted;
  };

  fitting::FittedCoupling fit(const rendering::StiffnessBounds& bounds,
                              const fitting::DeviceDemand& demand) const;
  void adopt(const fitting::FittedCoupling& fitted);
  void open_next();
  void spawn(std::uint64_t sample, std::int64_t taken_ns);
  void close(std::int64_t taken_ns);
  void keep(std::size_t index);
  void check(const fitting::FittedCoupling& fitted, std::size_t design);

  const scene::Scene& scene_;
  bool search_;
  coupling_node::ContactCoupling free_;
  const RecordedSession* session_ = nullptr;
  coupling::design::DeviceModel device_;
  fitting::FittedCoupling running_;
  rendering::StiffnessBounds bounds_;
  std::vector<Candidate> candidates_;  ///< none: nothing may run
  std::deque<Wanted> wanted_;          ///< designs that are not taken up yet
  bool open_ = false;                  ///< the first of them is being looked for
  std::size_t next_design_ = 0;        ///< of the session's, in the bag
  std::vector<std::string> notes_;
};

}  // namespace voxtouch::replay
