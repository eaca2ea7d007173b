// HTTP server of a study's site.
#pragma once

#include "item3d/study/site.h"

#include <memory>
#include <string>

namespace httplib {
class Server;
}

namespace item3d {

/// Adds all routes of the server, with their limits. `site` must outlive the server.
void add_study_routes(httplib::Server& server, StudySite& site);

/// Server that runs in its own threads from construction to destruction.
class StudyServer {
  public:
    /// `site` must outlive this object. With port 0, the server uses a free port. Throws
    /// ResourceError if the port is taken and InputError if the machine has no such host.
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
