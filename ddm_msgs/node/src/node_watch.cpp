// Notices that another node has died.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_node/node_watch.h"

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

#include "ddm_node/topic_peers.h"

namespace ddm {
namespace {

constexpr std::chrono::milliseconds kLook(5);
constexpr std::chrono::milliseconds kRetry(500);
constexpr int kConnectLimit_ms = 1000;

/// A connection to a process, closed with this.
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

  /// The other side has not ended it. Nobody sends anything here.
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
    if (error != 0) close();
  }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }

  int socket_ = -1;
};

}  // namespace

struct NodeWatch::State {
  std::mutex mutex;
  std::string node;  // that was heard last; empty: none yet
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
  state_->node = node;
  state_->died = false;
}

bool NodeWatch::died() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return state_->died;
}

void NodeWatch::watch(const std::shared_ptr<State>& state) {
  std::string watched;
  std::unique_ptr<Connection> connection;  // null: none, or the process of `watched` has ended
  for (;;) {
    std::this_thread::sleep_for(watched.empty() || connection != nullptr ? kLook : kRetry);
    std::string node;
    {
      const std::lock_guard<std::mutex> lock(state->mutex);
      if (state->ended) return;
      node = state->node;
    }
    if (node.empty()) continue;
    if (node == watched && connection != nullptr && connection->isOpen()) continue;
    const bool was_open = node == watched && connection != nullptr;
    watched = node;
    connection.reset();
    if (const auto address = addressOf(node)) {
      connection = std::make_unique<Connection>(address->host, address->port);
      if (!connection->isOpen()) connection.reset();
    }
    const std::lock_guard<std::mutex> lock(state->mutex);
    // A node that has never been in reach is not called dead.
    if (was_open && connection == nullptr && state->node == node) state->died = true;
  }
}

}  // namespace ddm
