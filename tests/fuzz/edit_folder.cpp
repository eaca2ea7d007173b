#include "item3d/io/edit_folder.h"

#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_json<0>(data, size, maximum, seed))

/// Reads edit.json of an edit or of a plan, beside a model.
ITEM3D_FUZZ_TARGET(edit_folder, data, size) {
    using namespace item3d;
    fuzz::as_file("model.glb", "");
    return fuzz::read_or_refuse([&] {
        read_edit_folder(fuzz::as_file("edit.json", fuzz::as_text(data, size)).parent_path());
    });
}
