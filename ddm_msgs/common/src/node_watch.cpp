// Detects that the process of another node has ended.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/node_watch.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <thread>
#include <utility>

#include "ddm_common/topic_peers.h"

namespace ddm {
namespace {

constexpr std::chrono::milliseconds kLook(5);
constexpr std::chrono::milliseconds kRetry(500);
constexpr int kConnectLimit_ms = 1000;

/// A connection to a process; the destructor closes it.
class Connection {
 public:
  Connection(const std::string& host, std::uint32_t port) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* addresses = nullptr;
    if (::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &addresses) != 0) return;
    for (addrinfo* each = addresses; each != nullptr && socket_ < 0; each = each->ai_next) {
      connect(*each);
    }
    ::freeaddrinfo(addresses);
  }
  ~Connection() { close(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Whether the connection was refused because no process listens at the address, for example
  /// because the process has ended.
  bool wasRefused() const { return refused_; }

  /// Whether the other process has not closed the connection. No data is sent on this connection.
  bool isOpen() const {
    char byte = 0;
    return socket_ >= 0 && ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) != 0 &&
           (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
  }

 private:
  void connect(const addrinfo& address) {
    socket_ = ::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) return;
    if (::connect(socket_, address.ai_addr, address.ai_addrlen) == 0) return;
    pollfd connected{socket_, POLLOUT, 0};
    int error = errno;
    if (error == EINPROGRESS && ::poll(&connected, 1, kConnectLimit_ms) == 1) {
      socklen_t size = sizeof(error);
      ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size);
    }
    refused_ = error == ECONNREFUSED;
    if (error != 0) close();
  }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }

  int socket_ = -1;
  bool refused_ = false;
};

}  // namespace

struct NodeWatch::State {
  std::mutex mutex;
  std::string node;     // node in the last call of hear(); empty before
  bool is_new = false;  // true if the thread has to connect: another node, or a node that had ended
  bool died = false;
  bool ended = false;
};

NodeWatch::NodeWatch() : state_(std::make_shared<State>()) { std::thread(watch, state_).detach(); }

NodeWatch::~NodeWatch() {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  state_->ended = true;
}

void NodeWatch::hear(const std::string& node) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  if (state_->node == node && !state_->died) return;
  state_->node = node;
  state_->died = false;
  state_->is_new = true;
}

bool NodeWatch::died() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return state_->died;
}

void NodeWatch::watch(const std::shared_ptr<State>& state) {
  std::string watched;
  // Null if there is no connection, or if the process of `watched` has ended.
  std::unique_ptr<Connection> connection;
  std::chrono::steady_clock::time_point next_try;
  for (;;) {
    std::this_thread::sleep_for(kLook);
    std::string node;
    bool is_new = false;
    {
      const std::lock_guard<std::mutex> lock(state->mutex);
      if (state->ended) return;
      node = state->node;
      std::swap(is_new, state->is_new);
    }
    const auto now = std::chrono::steady_clock::now();
    if (node.empty() || (!is_new && connection == nullptr && now < next_try)) continue;
    if (node == watched && connection != nullptr && connection->isOpen()) continue;
    bool is_gone = node == watched && connection != nullptr;
    watched = node;
    next_try = now + kRetry;
    connection.reset();
    if (const auto address = addressOf(node)) {
      connection = std::make_unique<Connection>(address->host, address->port);
      // If the connection is refused, the process that sent the last message has ended.
      is_gone = is_gone || connection->wasRefused();
      if (!connection->isOpen()) connection.reset();
    }
    const std::lock_guard<std::mutex> lock(state->mutex);
    // A node that could never be reached, for example behind a firewall, is not reported as ended.
    if (is_gone && connection == nullptr && state->node == node) state->died = true;
  }
}

}  // namespace ddm
