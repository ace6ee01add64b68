#pragma once
/// Serves the page's files and one WebSocket on one address, by libwebsockets, in a thread of its
/// own.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace voxtouch::view {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< an IPv4 address of this machine
  int port = 8765;                    ///< 0: any
  bool port_is_requested = false;     ///< fail if this port is in use
  std::string token;                  ///< empty: a new one
};

/// Limits for clients.
inline constexpr std::size_t kMaxClients = 64;
inline constexpr std::size_t kMaxConnections = 128;     ///< a browser opens several for one page
inline constexpr std::size_t kMaxMessageBytes = 65536;  ///< of a client [bytes]
inline constexpr int kMaxMessagesASecond = 100;  ///< of a client; control of the hand uses 60
inline constexpr std::size_t kMaxQueuedFrames =
    64;  ///< of one slow client; further frames are dropped for it

class PageServer {
 public:
  /// Receives a message of a client. Client numbers start at 1 and are never reused.
  using OnMessage = std::function<void(std::uint64_t client, std::string text)>;
  using OnClose = std::function<void(std::uint64_t client)>;

  /// `greeting` returns the first message to a new client after {"type": "page", "page": number}.
  /// The server's thread calls all three functions. Throws std::runtime_error, with a sentence, if
  /// the address is not available or a file of the page is missing.
  PageServer(const ServerOptions& options, std::function<std::string()> greeting,
             OnMessage received, OnClose closed);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  /// The address with the token, to print.
  std::string address() const;
  /// Sends to all clients, in order. A full queue drops frames but keeps facts. Thread-safe.
  void send_frame(std::string text);
  void send_fact(std::string text);
  std::size_t clients() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace voxtouch::view
