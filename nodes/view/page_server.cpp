#include "nodes/view/page_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <deque>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <libwebsockets.h>

#include "nodes/console/log.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/view/access.hpp"
#include "nodes/view/page_files.hpp"

namespace voxtouch::view {
namespace {

using Clock = std::chrono::steady_clock;

std::string header(lws* wsi, lws_token_indexes which) {
  char text[512];
  const int length = lws_hdr_copy(wsi, text, sizeof text, which);
  return length > 0 ? std::string(text, static_cast<std::size_t>(length)) : std::string();
}

std::string token_of(lws* wsi) {
  char text[128];
  const char* token = lws_get_urlarg_by_name(wsi, "token=", text, sizeof text);
  return token ? token : "";
}

/// Throws if `address` is not the address of one interface.
void check_address(const std::string& address) {
  in_addr place{};
  if (inet_pton(AF_INET, address.c_str(), &place) != 1 || place.s_addr == INADDR_ANY)
    throw std::runtime_error(
        fmt::format("'{}' is not an IPv4 address of one interface, such as 127.0.0.1", address));
}

/// Content security policy of every file: no foreign content, no embedding.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' "
    "data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

}  // namespace

class PageServer::Impl {
  /// A message with space for the header of libwebsockets in front.
  struct Outgoing {
    std::vector<unsigned char> bytes;
    bool frame = false;
  };
  using Shared = std::shared_ptr<Outgoing>;

  static Shared outgoing(std::string_view text, bool frame) {
    auto message = std::make_shared<Outgoing>();
    message->frame = frame;
    message->bytes.resize(LWS_PRE + text.size());
    std::memcpy(message->bytes.data() + LWS_PRE, text.data(), text.size());
    return message;
  }

  /// One WebSocket.
  struct Client {
    std::deque<Shared> queue;
    std::size_t frames = 0;  ///< number of frames in `queue`
    std::string incoming;
    Clock::time_point second{};
    int messages = 0;      ///< in this second
    bool refused = false;  ///< receives one sentence, then is closed
    std::uint64_t number = 0;
  };

 public:
  Impl(const ServerOptions& options, std::function<std::string()> greeting, OnMessage received,
       OnClose closed)
      : files_(find_page_files()),
        greeting_(std::move(greeting)),
        received_(std::move(received)),
        closed_(std::move(closed)) {
    check_address(options.address);
    access_ = {options.address, options.port, options.token.empty() ? make_token() : options.token};
    lws_set_log_level(0, nullptr);  // the message below reports a port in use
    lws_context_creation_info info{};
    info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND |
                   LWS_SERVER_OPTION_DISABLE_IPV6;
    info.fd_limit_per_thread = kMaxConnections + 8;  // plus the server's own
    info.pt_serv_buf_size = 16 * 1024;
    info.timeout_secs = 10;
    context_ = lws_create_context(&info);
    if (!context_)
      throw std::runtime_error("cannot create the page server");
    static const lws_protocols protocols[] = {
        {"voxtouch-view", &Impl::on_event, sizeof(Client*), kMaxMessageBytes, 0, nullptr, 0}, {}};
    info.port = access_.port;
    info.iface = access_.address.c_str();
    info.protocols = protocols;
    info.user = this;
    info.keepalive_timeout = 30;
    // A page that does not answer a ping (frozen, or its host is gone) loses its place after 20 s.
    static const lws_retry_bo_t idle{nullptr, 0, 0, 10, 20, 0};
    info.retry_and_idle_policy = &idle;
    lws_vhost* vhost = lws_create_vhost(context_, &info);
    if (!vhost && !options.port_is_requested) {
      info.port = 0;
      vhost = lws_create_vhost(context_, &info);
    }
    if (!vhost) {
      lws_context_destroy(context_);
      throw std::runtime_error(
          fmt::format("Cannot listen on {}:{}: not an address of this machine, or the port is in "
                      "use. Choose another --port (0: any free one)",
                      access_.address, access_.port));
    }
    lws_set_log_level(LLL_ERR,
                      [](int, const char* line) { console::log("page server: {}", line); });
    access_.port = lws_get_vhost_listen_port(vhost);
    thread_ = std::thread([this] {
      runtime::ordinary_priority();
      while (!stop_.load())
        lws_service(context_, 0);
    });
  }
  ~Impl() {
    stop_.store(true);
    lws_cancel_service(context_);
    thread_.join();
    lws_context_destroy(context_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  std::string address() const {
    return fmt::format("http://{}:{}/?token={}", access_.address, access_.port, access_.token);
  }
  std::size_t clients() const noexcept { return count_.load(); }

  void send(std::string_view text, bool frame) {
    {
      const std::lock_guard lock(mutex_);
      if (frame && to_send_.size() > kMaxQueuedFrames)
        return;
      to_send_.push_back(outgoing(text, frame));
    }
    lws_cancel_service(context_);
  }

 private:
  static int on_event(lws* wsi, lws_callback_reasons reason, void* session, void* in,
                      std::size_t length) {
    lws_vhost* vhost = lws_get_vhost(wsi);
    auto* self = vhost ? static_cast<Impl*>(lws_get_vhost_user(vhost)) : nullptr;
    if (!self)
      return 0;
    try {
      return self->handle_event(wsi, reason, static_cast<Client**>(session), in, length);
    } catch (const std::exception& error) {
      console::log("page server: {}\n", error.what());
      return -1;
    }
  }

  int handle_event(lws* wsi, lws_callback_reasons reason, Client** client, void* in,
                   std::size_t length) {
    switch (reason) {
      case LWS_CALLBACK_HTTP:
        return serve(wsi, std::string(static_cast<const char*>(in), length));
      case LWS_CALLBACK_HTTP_FILE_COMPLETION:
        return lws_http_transaction_completed(wsi) ? -1 : 0;
      case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        return client_refusal(wsi).empty() ? 0 : -1;
      case LWS_CALLBACK_ESTABLISHED:
        return open(wsi, client);
      case LWS_CALLBACK_RECEIVE:
        return receive(wsi, **client, {static_cast<const char*>(in), length});
      case LWS_CALLBACK_SERVER_WRITEABLE:
        return write(wsi, **client);
      case LWS_CALLBACK_CLOSED:
        return close(wsi, client);
      case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        return distribute();
      default:
        return lws_callback_http_dummy(wsi, reason, client, in, length);
    }
  }

  /// Checks Host and Origin; returns the reason for a refusal, or empty.
  std::string refusal(lws* wsi) const {
    if (const std::string host = header(wsi, WSI_TOKEN_HOST); !access_.admits_host(host))
      return "This server accepts requests to its own address only." + access_.remedy_for(host);
    if (!access_.admits_origin(header(wsi, WSI_TOKEN_ORIGIN)))
      return "Requests from pages of other sites are refused.";
    return {};
  }

  std::string client_refusal(lws* wsi) const {
    std::string why = refusal(wsi);
    if (why.empty() && !access_.admits_token(token_of(wsi)))
      why = "The token in the address is missing or invalid.";
    return why;
  }

  int serve(lws* wsi, const std::string& path) {
    std::string why = refusal(wsi);
    if (why.empty() && path == "/" && !access_.admits_token(token_of(wsi)))
      why = "The token in the address is missing or invalid: use the address printed by voxtouch.";
    if (!why.empty())
      return refuse(wsi, HTTP_STATUS_FORBIDDEN, why);
    const auto file = files_.find(path);
    if (file == files_.end())
      return refuse(wsi, HTTP_STATUS_NOT_FOUND, "Page not found.");
    unsigned char more[1024];
    unsigned char *at = more, *const end = more + sizeof more;
    const auto add = [&](const char* name, std::string_view value) {
      return lws_add_http_header_by_name(wsi, reinterpret_cast<const unsigned char*>(name),
                                         reinterpret_cast<const unsigned char*>(value.data()),
                                         static_cast<int>(value.size()), &at, end);
    };
    if (add("content-security-policy:", kPolicy) || add("x-content-type-options:", "nosniff") ||
        add("referrer-policy:", "no-referrer") || add("cache-control:", "no-cache"))
      return -1;
    const int sent =
        lws_serve_http_file(wsi, file->second.path.c_str(), file->second.mime.c_str(),
                            reinterpret_cast<char*>(more), static_cast<int>(at - more));
    if (sent < 0)
      return -1;
    return sent > 0 && lws_http_transaction_completed(wsi) ? -1 : 0;
  }

  static int refuse(lws* wsi, unsigned status, const std::string& sentence) {
    if (lws_return_http_status(wsi, status, sentence.c_str()) != 0)
      return -1;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
  }

  int open(lws* wsi, Client** client) {
    *client = new Client;                  // libwebsockets keeps the pointer; `close` deletes it
    if (clients_.size() >= kMaxClients) {  // a browser shows no reason of a refused WebSocket
      (*client)->refused = true;
      (*client)->queue.push_back(outgoing(
          fmt::format(
              R"({{"type":"refused","sentence":"{} pages are open, which is the limit: close one"}})",
              kMaxClients),
          false));
      lws_callback_on_writable(wsi);
      return 0;
    }
    clients_.insert({wsi, *client});
    count_.store(clients_.size());
    (*client)->number = ++last_number_;
    (*client)->queue.push_back(
        outgoing(fmt::format(R"({{"type":"page","page":{}}})", last_number_), false));
    (*client)->queue.push_back(outgoing(greeting_(), false));
    lws_callback_on_writable(wsi);
    return 0;
  }

  int close(lws* wsi, Client** client) {
    clients_.erase({wsi, *client});
    count_.store(clients_.size());
    if (*client && !(*client)->refused)
      closed_((*client)->number);
    delete std::exchange(*client, nullptr);
    return 0;
  }

  int receive(lws* wsi, Client& client, std::string_view part) {
    if (client.refused)
      return 0;
    const auto close_with = [&](lws_close_status status, const char* why) {
      std::string text = why;
      lws_close_reason(wsi, status, reinterpret_cast<unsigned char*>(text.data()), text.size());
      return -1;
    };
    if (client.incoming.size() + part.size() > kMaxMessageBytes)
      return close_with(LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, "too long");
    client.incoming += part;
    if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi) > 0)
      return 0;
    if (const auto now = Clock::now(); now - client.second > std::chrono::seconds(1))
      client.second = now, client.messages = 0;
    if (++client.messages > kMaxMessagesASecond)
      return close_with(LWS_CLOSE_STATUS_POLICY_VIOLATION, "too many messages");
    received_(client.number, std::exchange(client.incoming, {}));
    return 0;
  }

  int write(lws* wsi, Client& client) {
    if (client.queue.empty())
      return 0;
    const Shared message = client.queue.front();
    client.queue.pop_front();
    if (message->frame)
      --client.frames;
    const std::size_t size = message->bytes.size() - LWS_PRE;
    // Several clients get the same bytes: the header in front is written anew for each.
    if (lws_write(wsi, message->bytes.data() + LWS_PRE, size, LWS_WRITE_TEXT) <
        static_cast<int>(size))
      return -1;
    if (!client.queue.empty())
      lws_callback_on_writable(wsi);
    if (!client.refused)
      return 0;
    lws_close_reason(wsi, LWS_CLOSE_STATUS_GOINGAWAY, nullptr, 0);
    return -1;
  }

  /// Facts are rare; a client with so many queued is lost.
  int distribute() {
    std::deque<Shared> messages;
    {
      const std::lock_guard lock(mutex_);
      messages.swap(to_send_);
    }
    for (const auto& [wsi, client] : clients_) {
      for (const Shared& message : messages) {
        if (message->frame && client->frames >= kMaxQueuedFrames)
          continue;
        if (client->queue.size() >= 8 * kMaxQueuedFrames) {
          lws_set_timeout(wsi, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_ASYNC);
          break;
        }
        client->frames += message->frame ? 1 : 0;
        client->queue.push_back(message);
      }
      if (!client->queue.empty())
        lws_callback_on_writable(wsi);
    }
    return 0;
  }

  std::map<std::string, PageFile> files_;
  std::function<std::string()> greeting_;
  OnMessage received_;
  OnClose closed_;
  std::uint64_t last_number_ = 0;
  Access access_;
  lws_context* context_ = nullptr;
  std::set<std::pair<lws*, Client*>> clients_;  ///< the server's thread alone
  std::atomic<std::size_t> count_{0};
  std::mutex mutex_;
  std::deque<Shared> to_send_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

PageServer::PageServer(const ServerOptions& options, std::function<std::string()> greeting,
                       OnMessage received, OnClose closed)
    : impl_(std::make_unique<Impl>(options, std::move(greeting), std::move(received),
                                   std::move(closed))) {}
PageServer::~PageServer() = default;
std::string PageServer::address() const { return impl_->address(); }
void PageServer::send_frame(std::string text) { impl_->send(text, true); }
void PageServer::send_fact(std::string text) { impl_->send(text, false); }
std::size_t PageServer::clients() const noexcept { return impl_->clients(); }

}  // namespace voxtouch::view
