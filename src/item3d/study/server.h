// A study's site on a socket.
#pragma once

#include "item3d/study/site.h"

#include <memory>
#include <string>

namespace httplib {
class Server;
}

namespace item3d {

/// What the server answers, within which bounds. site outlives it.
void add_study_routes(httplib::Server& server, StudySite& site);

/// Answers requests in threads of its own, from the constructor to the destructor.
class StudyServer {
  public:
    /// site outlives it. port 0: a free one. Throws ResourceError where the port is taken and
    /// InputError where the machine has no such host.
    StudyServer(StudySite& site, const std::string& host, int port);
    ~StudyServer();
    StudyServer(const StudyServer&) = delete;
    StudyServer& operator=(const StudyServer&) = delete;

    int port() const;

  private:
    struct Sockets;
    std::unique_ptr<Sockets> sockets_;
};

}  // namespace item3d
