#pragma once
/// Asks a ring that runs to change something, and waits for its answer: what `voxtouch change` and
/// the page of `voxtouch view` share.
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::runtime {

/// What is to be changed, in the words of the command line.
struct ChangeWords {
  std::vector<std::string> words;  ///< EFFECT on|off, EFFECT gain X, EFFECT PARAMETER=VALUE[,V,V]
                                   ///< ...; none with `reload`
  bool reload = false;
  double voxel_size_m = 0.0;  ///< with `reload`; 0: as the file says
  std::string model;          ///< with `reload`; empty: as the file says
  std::uint64_t from_sample = 0;
};

/// One message to be.
struct ChangeRequest {
  std::uint32_t action = 0;
  std::string effect, parameter;
  std::array<double, 3> value{};
};
/// One for each change that the words ask for. Throws std::runtime_error, a sentence, for words
/// that ask for none.
std::vector<ChangeRequest> read_changes(const ChangeWords& words);

/// Something was done.
struct ChangeAnswer {
  std::uint64_t from_sample = 0;
  std::string sentence;  ///< what
};

/// One thread at a time; allocates and waits.
class ChangeAsker {
 public:
  ChangeAsker(const bus::Participant& participant, const NodeOptions& options);

  /// Asks one thing after the other and stops at the first that is not done. `answered` is called
  /// with each answer, in order, and `waits` where the rendering says that one takes time; it may
  /// take what it takes, until `leave`. Gives the sentence of what was not done, empty where all
  /// was.
  std::string ask(
      const ChangeWords& words, const std::function<void(const ChangeAnswer&)>& answered,
      const std::function<void(const std::string&)>& waits,
      const std::function<bool()>& leave = [] { return false; });

 private:
  struct Message {
    std::uint32_t result = 0;
    std::uint64_t session = 0, from_sample = 0;
    std::string sentence;
  };
  std::optional<Message> ask_in_session(const ChangeRequest& change, const ChangeWords& words,
                                        const std::function<void(const std::string&)>& waits,
                                        const std::function<bool()>& leave);
  std::optional<Message> ask_one(const ChangeRequest& change, const ChangeWords& words,
                                 const std::function<void(const std::string&)>& waits,
                                 const std::function<bool()>& leave);
  void send(const ChangeRequest& change, const ChangeWords& words, std::uint64_t request);
  std::string no_rendering() const;

  std::string rig_;
  std::uint32_t domain_;
  bus::Writer<msg::EffectChange> changes_;
  bus::Reader<msg::EffectChanged> answers_;
  bus::Reader<msg::ScenePlan> plans_;  ///< the rendering says in it which session runs
  std::uint64_t session_ = 0;  ///< that is asked: a question that stands in a bag and is played
                               ///< belongs to none that runs, and is refused
};

}  // namespace voxtouch::runtime
