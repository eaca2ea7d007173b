#include "item3d/io/image/ktx2_module.h"

#include <encoder/basisu_comp.h>

#include <cstring>

extern "C" __attribute__((visibility("default"))) bool item3d_encode_ktx2(
    const item3d::Ktx2Image& picture, std::vector<std::uint8_t>& file) {
    basisu::basisu_encoder_init();
    basisu::job_pool threads(static_cast<std::uint32_t>(picture.threads));
    basisu::basis_compressor_params params;
    basisu::image image(static_cast<std::uint32_t>(picture.width),
                        static_cast<std::uint32_t>(picture.height));
    std::memcpy(
        image.get_ptr(), picture.rgba,
        4 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
    params.m_source_images.push_back(image);
    params.m_pJob_pool = &threads;
    params.m_multithreading = picture.threads > 1;
    params.m_status_output = false;
    params.m_print_stats = false;
    params.m_check_for_alpha = picture.has_alpha;
    params.m_perceptual = picture.is_srgb;
    params.m_mip_gen = true;
    params.m_mip_srgb = picture.is_srgb;
    params.m_create_ktx2_file = true;
    params.m_ktx2_srgb_transfer_func = picture.is_srgb;
    params.m_uastc = picture.is_precise;
    params.m_ktx2_uastc_supercompression = basist::KTX2_SS_ZSTANDARD;
    params.m_ktx2_zstd_supercompression_level = 9;
    params.m_rdo_uastc = picture.is_precise;
    params.m_rdo_uastc_quality_scalar = 0.5f;
    params.m_quality_level = picture.quality;
    basisu::basis_compressor compressor;
    if (!compressor.init(params) || compressor.process() != basisu::basis_compressor::cECSuccess)
        return false;
    const basisu::uint8_vec& bytes = compressor.get_output_ktx2_file();
    file.insert(file.end(), bytes.begin(), bytes.end());
    return true;
}
