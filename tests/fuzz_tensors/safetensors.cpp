#include "item3d/tensors/safetensors.h"

#include "tests/fuzz/mutate.h"

ITEM3D_FUZZ_MUTATOR(item3d::fuzz::mutate_framed(data, size, maximum, seed,
                                                item3d::fuzz::split_safetensors,
                                                item3d::fuzz::join_safetensors))

/// Reads the last element of each tensor.
ITEM3D_FUZZ_TARGET(safetensors, data, size) {
    using namespace item3d;
    return fuzz::read_or_refuse([&] {
        const SafeTensors file =
            SafeTensors::open(fuzz::as_file("model.safetensors", fuzz::as_text(data, size)));
        file.total_elements();
        for (const auto& [name, tensor] : file.tensors()) {
            ITEM3D_CHECK(tensor.sizes() == file.info(name).shape, "of the header's shape");
            if (tensor.numel() > 0) tensor.reshape({-1})[-1].to(at::kDouble).item<double>();
            file.release_pages(name);
        }
    });
}
