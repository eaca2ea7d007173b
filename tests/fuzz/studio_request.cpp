#include "item3d/studio/http.h"
#include "item3d/studio/server.h"
#include "tests/fuzz/http_request.h"

namespace {

/// A studio with one project. The programs that it would start do not exist.
struct FuzzedStudio {
    item3d::Studio studio;
    item3d::fuzz::OpenServer server;
    item3d::StudioRoutes routes{server, studio};

    FuzzedStudio() : studio(options()) {
        studio.store().set_model(studio.store().add_project("mug"), "mug.glb",
                                 {{"materials", {{{"index", 0}, {"name", "glaze"}}}}});
        studio.events().close();
        add_studio_routes(routes);
    }
    static item3d::StudioOptions options() {
        const auto settings = item3d::fuzz::as_file("settings.json", R"([
            {"name": "from", "flag": "--from", "type": "text"},
            {"name": "keep", "flag": "--keep", "type": "texts"},
            {"name": "seed", "flag": "--seed", "type": "integer"}])");
        item3d::fuzz::as_file("index.html", "<p>the page</p>");
        const auto page = settings.parent_path();
        std::filesystem::create_directories(page / "studio");
        return {page / "studio", page, page, page / "programs", {"secret", "", "cookie", ""}};
    }
};

}  // namespace

/// Answers a request. If the request names no host and no token, it gets the page's own. Requests
/// for the image of a light take a hundred times as long as others and have a target of their own
/// (light_request), so few of them are answered.
ITEM3D_FUZZ_TARGET(studio_request, data, size) {
    using namespace item3d;
    static FuzzedStudio fuzzed;
    if (fuzz::as_text(data, size).starts_with("GET /api/lights/") && size % 32 != 0) return 0;
    return fuzz::read_or_refuse([&] {
        fuzzed.server.answer(fuzz::as_text(data, size), [](httplib::Request& request) {
            for (const auto& [name, value] :
                 {std::pair{"Host", "localhost"}, {"X-Item3d-Token", "secret"}})
                if (!request.has_header(name)) request.set_header(name, value);
        });
    });
}
