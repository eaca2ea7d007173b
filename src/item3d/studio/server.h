// HTTP server of the studio.
#pragma once

#include "item3d/studio/studio.h"

#include <memory>
#include <string>

namespace item3d {

struct StudioRoutes;  // http.h

/// Adds all routes of the studio's server, with their limits.
void add_studio_routes(StudioRoutes& routes);

/// Server that runs in its own threads from construction to destruction.
class StudioServer {
  public:
    /// `studio` must outlive this object. With port 0, the server uses a free port. Throws like
    /// HttpListener.
    StudioServer(Studio& studio, const std::string& host, int port);
    ~StudioServer();
    StudioServer(const StudioServer&) = delete;
    StudioServer& operator=(const StudioServer&) = delete;

    int port() const;

  private:
    struct Sockets;
    std::unique_ptr<Sockets> sockets_;
};

}  // namespace item3d
