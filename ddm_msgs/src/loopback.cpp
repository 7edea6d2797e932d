// Keeps the XML-RPC server of a node to the loopback interface where its other sockets keep to it.
// SPDX-License-Identifier: BSD-3-Clause
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace {

/// The rule by which roscpp keeps its TCPROS and UDPROS sockets to the loopback interface.
bool onlyLoopback() {
  const char* name = std::getenv("ROS_HOSTNAME");
  if (name != nullptr && std::strcmp(name, "localhost") == 0) return true;
  const char* address = std::getenv("ROS_IP");
  return address != nullptr && std::strncmp(address, "127.", 4) == 0;
}

}  // namespace

/// Stands before that of the C library. roscpp offers its XML-RPC server on all interfaces whatever
/// ROS_HOSTNAME says and has no option for it, and through XML-RPC anybody may name a node another
/// publisher to listen to: torques, say.
extern "C" int bind(int fd, const sockaddr* address, socklen_t length) noexcept {
  sockaddr_in local{};
  if (length == sizeof(local) && address->sa_family == AF_INET && onlyLoopback()) {
    std::memcpy(&local, address, sizeof(local));
    if (local.sin_addr.s_addr == htonl(INADDR_ANY)) local.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address = reinterpret_cast<const sockaddr*>(&local);
  }
  return static_cast<int>(::syscall(SYS_bind, fd, address, length));
}
