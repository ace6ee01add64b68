#include "nodes/rendering/change_inbox.hpp"

#include <algorithm>
#include <random>

#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

/// Random number of a change requested by a service; a collision with another one is negligible.
std::uint64_t request_number() {
  static thread_local std::random_device random;
  return (std::uint64_t{random()} << 32U | random()) | 1U;
}

}  // namespace

ChangeInbox::ChangeInbox(const bus::Participant& participant, const runtime::NodeOptions& options,
                         Receive receive, std::function<std::vector<RosParameter>()> parameters)
    : changes_(participant, qos::kEffectChange, options.rig,
               qos::profile_in(qos::kEffectChange, options.mode())),
      answers_(participant, qos::kEffectChanged, options.rig,
               qos::profile_in(qos::kEffectChanged, options.mode())),
      made_(participant, qos::kEffectMade, options.rig,
            qos::profile_in(qos::kEffectMade, options.mode())),
      receive_(std::move(receive)),
      services_(
          participant, options.rig, options.lockstep,
          {[this](auto requested, bool together, const bus::Guid& by, const ChangeReply& reply) {
             handle_request(requested, together, by, reply);
           },
           std::move(parameters)}),
      wait_set_(participant) {
  wait_set_.attach(changes_.condition());
  services_.attach_to(wait_set_);
}

void ChangeInbox::serve(std::uint64_t session,
                        const std::function<bool(std::uint64_t id)>& pending) {
  session_ = session;
  changes_.take_each([&](const msg::EffectChange& m, dds_instance_handle_t writer) {
    const auto found = std::ranges::find(answered_, m.request, &Answered::id);
    if (m.request != 0 && found != answered_.end())
      return send(*found);
    if (m.request != 0 && pending(m.request))
      return;
    count(bus::participant_of_writer(changes_.get(), writer), 1);
    receive_(std::span(&m, 1), false,
             std::vector<ChangeRequest>{
                 {.id = m.request, .session = m.session_id, .from_sample = m.from_sample}});
  });
  services_.serve();
}

/// Queues a service request like a message.
void ChangeInbox::handle_request(std::span<const msg::EffectChange> requested, bool together,
                                 const bus::Guid& by, const ChangeReply& reply) {
  count(by, requested.size());
  std::vector<ChangeRequest> requests;
  for (std::size_t n = 0; n < requested.size(); ++n)
    requests.push_back(
        {.id = request_number(),
         .session = requested[n].session_id,
         .from_sample = requested[n].from_sample,
         .reply = [reply, n](bool done, std::uint64_t sample, const std::string& sentence) {
           reply(n, done, sample, sentence);
         }});
  if (together)
    return receive_(requested, true, std::move(requests));
  for (std::size_t n = 0; n < requested.size(); ++n)
    receive_(requested.subspan(n, 1), false, std::vector{std::move(requests[n])});
}

void ChangeInbox::count(const bus::Guid& by, std::size_t changes) {
  constexpr std::size_t kMaxCounted = 64;
  const std::lock_guard lock(mutex_);
  requests_[requests_.size() < kMaxCounted || requests_.contains(by) ? by : bus::Guid{}] += changes;
}

std::map<bus::Guid, std::uint64_t> ChangeInbox::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}

void ChangeInbox::send(const Answered& answer) {
  msg::EffectChanged m{};
  m.request = answer.id;
  m.session_id = session_;
  m.from_sample = answer.sample;
  m.result = answer.result;
  m.sentence = runtime::lend(answer.sentence);
  answers_.write(m);
}

void ChangeInbox::answer(const ChangeRequest& request, std::uint32_t result, std::uint64_t sample,
                         const std::string& sentence) {
  using namespace msg::effect_changed;
  constexpr std::size_t kRemembered = 256;
  std::erase_if(answered_, [&](const Answered& a) { return a.id == request.id; });
  answered_.push_back({request.id, sample, result, sentence});
  if (answered_.size() > kRemembered)
    answered_.pop_front();
  send(answered_.back());
  if (request.reply && result != kResultPending)
    request.reply(result == kResultDone, sample, sentence);
}

void ChangeInbox::refuse(const ChangeRequest& request, const std::string& sentence) {
  refused_.fetch_add(1);
  answer(request, msg::effect_changed::kResultRefused, 0, sentence);
}

/// A recorder may not have discovered the requesting participant. It has discovered this writer.
void ChangeInbox::record(const ChangeRequest& request, std::uint64_t session,
                         std::uint64_t sample) {
  msg::EffectChange made = request.change.made(session, sample);
  made.request = request.id;
  made_.write(made);
}

}  // namespace voxtouch::rendering_node
