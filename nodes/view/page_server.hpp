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
  bool port_is_requested =
      false;          ///< this very port was requested: where it is taken, that is an error
  std::string token;  ///< empty: a new one
};

/// Bounds of what clients may cost.
inline constexpr std::size_t kMaxClients = 64;
inline constexpr std::size_t kMaxConnections = 128;     ///< a browser opens several for one page
inline constexpr std::size_t kMaxMessageBytes = 65536;  ///< of a client [bytes]
inline constexpr int kMaxMessagesASecond = 100;  ///< of a client; one that leads the hand sends 60
inline constexpr std::size_t kMaxWaiting =
    64;  ///< frames for a client that is slow; what comes then is left out for it

class PageServer {
 public:
  /// What a client sends; it is a number from 1 on, and of no other one.
  using Heard = std::function<void(std::uint64_t client, std::string text)>;
  using Closed = std::function<void(std::uint64_t client)>;

  /// `greeting` gives what a client that has just come must know, as one message, after
  /// {"type": "page", "page": its number}. All three are called from the server's thread. Throws
  /// std::runtime_error, a sentence, where the address cannot be had or the page's files are
  /// missing.
  PageServer(const ServerOptions& options, std::function<std::string()> greeting, Heard received,
             Closed closed);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  /// For people, with the token.
  std::string address() const;
  /// To all clients, in order. A frame is left out for a client that has too many waiting; a fact
  /// waits for it. Any thread.
  void send_frame(std::string text);
  void send_fact(std::string text);
  std::size_t clients() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace voxtouch::view
