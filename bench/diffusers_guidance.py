#!/usr/bin/env python3
"""Measures time and memory of one guidance step (method RDL) in item3d and in diffusers.

    bench/diffusers_guidance.py ITEM3D PRIOR --size 256 --batch 2 --precision bf16 --threads 2

PRIOR is a folder of Stable Diffusion. Its weights may be random, which does not change the time. The script measures
three variants, named as in docs/benchmarks.md:

    published   diffusers with four U-Net rows per image. ITEM3D's published code needs them for classifier-free
                guidance of both sentences
    two rows    diffusers with the two U-Net rows per image that the difference of the sentences needs
    item3d      item3d, which also uses two rows per image

A step includes the VAE encoder and the gradient with respect to the image. It does not include the adjustment of the
source sentence. The script needs the Python packages torch, diffusers and transformers. It prints a table, then one
line of JSON.
"""
import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import time

os.environ.setdefault("HF_HUB_OFFLINE", "1")
PROMPTS = {"target": "a golden mug", "source": "a red mug", "none": ""}


def time_diffusers(options, rows):
    """Returns the median time of a step in seconds, and the peak memory of this process in bytes."""
    import torch
    from diffusers import AutoencoderKL, DDPMScheduler, UNet2DConditionModel
    from transformers import CLIPTextModel, CLIPTokenizer

    torch.set_num_threads(options.threads)
    torch.manual_seed(0)
    dtype = {"fp32": torch.float32, "bf16": torch.bfloat16}[options.precision]

    def load(kind, part, **more):
        return kind.from_pretrained(options.prior, subfolder=part, **more).eval().requires_grad_(False)

    vae = load(AutoencoderKL, "vae", torch_dtype=dtype)
    unet = load(UNet2DConditionModel, "unet", torch_dtype=dtype)
    scheduler = DDPMScheduler.from_pretrained(options.prior, subfolder="scheduler")
    tokenizer = CLIPTokenizer.from_pretrained(options.prior, subfolder="tokenizer")
    encoder = load(CLIPTextModel, "text_encoder", torch_dtype=dtype)
    with torch.no_grad():
        text = {
            name: encoder(
                tokenizer(prompt, padding="max_length", max_length=77, truncation=True, return_tensors="pt").input_ids
            )[0].repeat(options.batch, 1, 1)
            for name, prompt in PROMPTS.items()
        }
    del encoder
    image = torch.rand(options.batch, 3, options.size, options.size, requires_grad=True)
    scale = 7.5

    def predict(noisy, timesteps, names):
        count = len(names)
        return unet(
            torch.cat([noisy] * count),
            torch.cat([timesteps] * count),
            encoder_hidden_states=torch.cat([text[name] for name in names]),
        ).sample.chunk(count)

    def step():
        image.grad = None
        timesteps = torch.randint(20, 981, [options.batch])
        latents = vae.encode((2 * image - 1).to(dtype)).latent_dist.mean * vae.config.scaling_factor
        with torch.no_grad():
            noisy = scheduler.add_noise(latents, torch.randn_like(latents), timesteps)
            if rows == 4:
                none, target = predict(noisy, timesteps, ["none", "target"])
                target = none + scale * (target - none)
                none, source = predict(noisy, timesteps, ["none", "source"])
                source = none + scale * (source - none)
            else:
                target, source = predict(noisy, timesteps, ["target", "source"])
            gradient = target - source
        latents.backward(gradient)

    step()
    seconds = []
    for _ in range(options.repeats):
        start = time.perf_counter()
        step()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def in_a_process_of_its_own(options, rows):
    command = [sys.executable, __file__, *sys.argv[1:], "--rows", str(rows)]
    return tuple(json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout))


def time_item3d(options):
    command = [options.item3d, "bench", "guidance", "--prior", options.prior, "--size", str(options.size),
               "--batch", str(options.batch), "--precision", options.precision, "--threads", str(options.threads),
               "--repeats", str(options.repeats), "--quiet", "--json", "--device", "cpu"]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return found["seconds_per_step"], found["peak_memory_bytes"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("item3d", help="the program")
    parser.add_argument("prior", help="folder of Stable Diffusion")
    parser.add_argument("--size", type=int, default=512, help="width and height of the images in pixels")
    parser.add_argument("--batch", type=int, default=2, help="number of images in a step")
    parser.add_argument("--precision", choices=["fp32", "bf16"], default="bf16", help="data type of the networks")
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="number of threads")
    parser.add_argument("--repeats", type=int, default=3, help="number of measured steps")
    parser.add_argument("--rows", type=int, choices=[2, 4], help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.rows:
        print(json.dumps(time_diffusers(options, options.rows)))
        return
    found = {
        "published": in_a_process_of_its_own(options, 4),
        "two rows": in_a_process_of_its_own(options, 2),
        "item3d": time_item3d(options),
    }
    ours = found["item3d"]
    print(f"{options.size} x {options.size}, batch {options.batch}, {options.precision}, {options.threads} threads")
    for name, (seconds, peak) in found.items():
        print(f"  {name:22}{seconds:8.2f} s  {seconds / ours[0]:5.2f} times item3d's  {peak / 1e9:6.2f} GB")
    print(json.dumps({name: {"seconds": seconds, "peak_memory_bytes": peak} for name, (seconds, peak) in found.items()}))


if __name__ == "__main__":
    main()
