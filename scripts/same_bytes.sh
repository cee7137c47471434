#!/usr/bin/env bash
# Whether a change of the code changes a number: bakes a fixed set of small tables and lights and prints a line
# "sha256  path" for each file of values, and for each manifest without its times, hashes and version.
#
#     scripts/same_bytes.sh path/to/gonio [OUTDIR] > hashes.txt
#     scripts/same_bytes.sh --compare old-gonio new-gonio [OUTDIR]
#
# --compare says what differs and exits with 1, or that nothing does. Whatever else goes wrong exits with 2. OUTDIR
# keeps what was baked. Hashes are those of a machine and its driver: compare on one.
set -Eeuo pipefail
trap 'exit 2' ERR
export LC_ALL=C
recipes=$(cd "$(dirname "$0")" && pwd)/same_bytes
demo=$recipes/../../assets/demo

microfacets=(ggx beckmann gtr blinn-phong charlie)
anisotropic=(ggx-anisotropic beckmann-anisotropic)
rough=(oren-nayar fujii eon burley frostbite gltf_oren_nayar disney-subsurface ward-dur blinn phong lafortune
    ashikhmin-shirley)
smooth=(lambert gltf_diffuse disney-sheen ashikhmin-shirley-diffuse)
maskings=(smith-correlated smith-separable schlick-ggx schlick-ggx-direct v-cavity kelemen ashikhmin-neubelt
    disney-clearcoat none)
fresnels=(schlick generalized-schlick none dielectric conductor f82 thin-film)
# What is not at its default.
declare -A settings=([gtr]='gamma = 1.5' [eon]='albedo = 0.7' [lafortune]=$'cxy = -0.8\ncz = 0.7'
    [ggx-anisotropic]='aspect = 3' [beckmann-anisotropic]='aspect = 0.4')

# table NAME MODEL QUANTITY [ROUGHNESS [LINE…]]: ROUGHNESS is its axis.
table() {
    local model=$2 quantity=$3 axes=
    case $model.$quantity in
        *anisotropic.brdf) axes='theta_i = 4, phi_i = 3, theta_e = 4, phi_e = 5' ;;
        *anisotropic.rho_dh) axes='theta_i = 4, phi_i = 3' ;;
        *anisotropic.split_sum) axes='mu = 4, phi_i = 3' ;;
        *.brdf) axes='theta_i = 5, theta_e = 8, delta_phi = 8' ;;
        *.rho_dh) axes='theta_i = 8' ;;
        *.split_sum) axes='mu = 8' ;;
    esac
    if [ -n "${4:-}" ]; then axes+="${axes:+, }roughness = $4"; fi
    printf '[[tables]]\nname = "%s.%s"\nmodel = "%s"\nquantity = "%s"\naxes = { %s }\n%s\n' \
        "$1" "$quantity" "$model" "$quantity" "$axes" "${settings[$model]:-}"
    printf '%s\n' "${@:5}"
}

# Every quantity of these models, integrals at the ends of the roughness too.
quantities() {
    local count=$1 model
    for model in "${@:2}"; do
        table "$model" "$model" brdf "$count"
        for quantity in rho_dh rho_hh split_sum; do
            table "$model" "$model" $quantity "{ count = $count, positions = \"nodes\" }"
        done
    done
}

isotropic_recipe() {
    quantities 4 "${microfacets[@]}" "${rough[@]}"
    table ward ward brdf 4
    for quantity in rho_dh rho_hh split_sum; do table mirror mirror $quantity; done
    for quantity in brdf rho_dh rho_hh split_sum; do
        for model in "${smooth[@]}"; do table "$model" "$model" $quantity; done
    done
}

anisotropic_recipe() { quantities 3 "${anisotropic[@]}"; }

# Tables that are spread from few integrals.
spread_recipe() {
    for model in "${microfacets[@]}" "${rough[@]}"; do
        table "$model" "$model" split_sum 64
        table "$model" "$model" rho_hh 64
    done
}

# Every pair of NDF and masking, NDF and Fresnel, masking and Fresnel.
parts_recipe() {
    local ndfs=("${microfacets[@]}" "${anisotropic[@]}") n m name lines
    for n in "${!ndfs[@]}"; do
        for m in "${!maskings[@]}"; do
            local masking=${maskings[m]} fresnel=${fresnels[(n + m) % ${#fresnels[@]}]}
            name=${ndfs[n]}.$masking.$fresnel
            lines=("masking = \"$masking\"" "fresnel = \"$fresnel\"")
            table "$name" "${ndfs[n]}" brdf 2 "${lines[@]}"
            # The rest has no bound.
            case $name in *.none.* | charlie.schlick-ggx.*) continue ;; esac
            table "$name" "${ndfs[n]}" split_sum 2 "${lines[@]}"
        done
    done
    for fresnel in "${fresnels[@]}"; do table "mirror.$fresnel" mirror rho_dh '' "fresnel = \"$fresnel\""; done
    for name in kulla-conty turquin; do
        for quantity in brdf rho_dh rho_hh; do
            table "ggx.$name" ggx $quantity 2 "compensation = \"$name\"" 'fresnel = "none"'
        done
    done
}

rules_recipe() {
    local rule name
    for rule in 'grid = [32, 64]' 'gauss = [16, 32]' 'hammersley = 64' 'vndf = 64' 'random = 64'; do
        for model in ggx beckmann charlie oren-nayar phong; do
            # Only GGX is sampled.
            case $model.$rule in [^g]*.[hvr]*) continue ;; esac
            name=$model.${rule%% *}
            for quantity in rho_dh rho_hh split_sum; do
                table "$name" $model $quantity 4 "rule = { $rule }"
            done
        done
    done
}

storages_recipe() {
    for storage in f32 f64 f16 unorm16; do
        local line="storage = \"$storage\""
        table lambert.$storage lambert brdf '' "$line"
        for model in ggx eon; do table $model.$storage $model split_sum 8 "$line"; done
    done
}

# More values, of A and B, than the 2²⁵ that are baked in one piece.
streamed_recipe() {
    printf '[[tables]]\nmodel = "ggx"\nquantity = "brdf"\nroughness = 0.3\naxes = { %s }\n' \
        'theta_i = 128, theta_e = 256, delta_phi = 513'
}

# A small map with a bright texel, and pairs of directions, every fourth at the mirror.
inputs() {
    python3 - <<'END'
texels = [[40 + 13 * x, 60 + 20 * y, 90 + 5 * x + 9 * y, 136 if (x, y) == (5, 2) else 128]
          for y in range(8) for x in range(16)]
with open("map.hdr", "wb") as file:
    file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + bytes(sum(texels, [])))
with open("pairs.csv", "w") as file:
    for k in range(1, 201):
        a, b, c, d = (k * step % 1 for step in (0.8566748838, 0.7338918566, 0.6287067210, 0.5385972572))
        if k % 4 == 0:
            c, d = a, b + 0.5 + k * 1e-8
        print(f"{1.57 * a!r},{6.283185307 * b!r},{1.57 * c!r},{6.283185307 * d!r}", file=file)
END
}

# Hashes of what is below this folder, but for in/, by plain names: those in files/ have the content in them.
hashes() {
    python3 - <<'END'
import hashlib, json, pathlib

def stays(value):
    if isinstance(value, dict):
        dropped = ("seconds", "stages", "gonio", "sha256", "files")
        return {key: stays(of) for key, of in value.items() if key not in dropped}
    return [stays(of) for of in value] if isinstance(value, list) else value

for path in sorted(path.as_posix() for path in pathlib.Path(".").rglob("*.*")):
    if "/files/" in path:
        continue
    elif path.endswith(".npy"):
        data = pathlib.Path(path).read_bytes()
    elif path.endswith(".json"):
        data = json.dumps(stays(json.loads(pathlib.Path(path).read_bytes())), indent=1).encode()
    else:
        continue
    print(f"{hashlib.sha256(data).hexdigest()}  {path}")
END
}

# run NAME COMMAND ARGUMENT…, into the folder of the device.
run() {
    local out=$device/$1
    mkdir -p "$out"
    if ! "$gonio" "${@:2}" --device "$device" --out "$out${file:+/$file}" >log 2>&1; then
        { echo "$gonio ${*:2} --device $device fails:" && tail -n 20 log; } >&2
        exit 2
    fi
}
bake() { run "$1" bake "${@:2}" --format npy --check "${check:-0}"; }
light() { run "light-$1" light "${@:2}" --format npy --check 0 --no-picture; }
evaluate() { file=values.npy run "eval-$1" eval "${@:2}" --pairs in/pairs.csv; }

# everything GONIO OUTDIR
everything() (
    gonio=$(realpath -e "$1")
    mkdir -p "$2" && cd "$2"
    if [ -n "$(ls -A)" ]; then echo "$2 is not empty; give a new folder" >&2 && exit 2; fi
    mkdir in
    cp "$recipes"/* "$demo"/demo* in
    for name in isotropic anisotropic spread parts rules storages streamed; do "${name}_recipe" >"in/$name.toml"; done
    (cd in && inputs)

    for device in auto cpu; do
        for tolerance in 1e-3 1e-6 1e-8; do
            bake isotropic-$tolerance in/isotropic.toml --tolerance $tolerance
        done
        bake anisotropic in/anisotropic.toml --tolerance 1e-3
        for tolerance in 1e-6 1e-8; do
            bake anisotropic-$tolerance in/anisotropic.toml --tolerance $tolerance --quantity split_sum
        done
        bake spread in/spread.toml
        bake parts in/parts.toml
        bake rules in/rules.toml --tolerance 1
        bake materials in/materials.toml
        bake demo in/demo.gltf
        bake layers in/layers.gltf --quantity rho_dh
        # With a check, integrals are done again by a finer rule, and some are replaced.
        check=1 bake storages in/storages.toml --tolerance 1e-3
        check=1 bake axes in/axes.toml
        if [ $device = auto ]; then bake streamed in/streamed.toml; fi

        light irradiance --env in/map.hdr --rotate 20 --normals 4x8
        light sh-map --env in/map.hdr --quantity sh --normals 4x8
        light sh-sky --sky sky:zenith=1/2/3,horizon=0.5,ground=0.2 --quantity sh --normals 4x8
        light sh-disk --sky disk:theta=70,phi=10,radius=30,radiance=3 --quantity sh --normals 4x8
        light sh-sun --sky sun:theta=40,phi=10,irradiance=3 --quantity sh --normals 4x8
        local radiance=(--quantity radiance --exits 3x2 --tolerance 1e-2)
        light map ggx --roughness 0.5,0.7 --env in/map.hdr "${radiance[@]}"
        light sky beckmann --roughness 0.5 --sky sky:zenith=1/2/3,horizon=0.5,ground=0.2 "${radiance[@]}"
        light disk in/materials.toml --material kulla --sky disk:theta=40,phi=10,radius=20,radiance=3 "${radiance[@]}"
        light sun in/materials.toml --material brushed --sky sun:theta=40,phi=10,irradiance=3 "${radiance[@]}"
        light constant in/layers.gltf --material coat --sky constant:2 "${radiance[@]}"
        light radiosity ggx --set roughness=0.5 --env in/map.hdr --quantity radiosity --normals 2x4 --tolerance 1e-2
        light radiosity-sky lambert --set albedo=0.8 --sky sky:zenith=1,horizon=0.5,ground=0.2 --quantity radiosity \
            --normals 2x4

        # No anisotropic ones, which are evaluated in tables only.
        for name in diffuse slopes classics ward gold film kulla turquin velvet clearcoat; do
            evaluate $name in/materials.toml --material $name
        done
        for name in coat sheen film; do evaluate layers-$name in/layers.gltf --material $name; done
    done
    hashes
)

compare=
if [ "${1:-}" = --compare ]; then compare=yes && shift; fi
binaries=1${compare:+ + 1}
if [ $# -lt $((binaries)) ] || [ $# -gt $((binaries + 1)) ]; then
    sed -n '/^#  /s/^# *//p' "$0" >&2
    exit 2
fi
out=${*:$((binaries + 1))}
if [ -z "$out" ]; then out=$(mktemp -d) && trap 'rm -rf "$out"' EXIT; fi

if [ -z "$compare" ]; then
    everything "$1" "$out"
    exit
fi
mkdir -p "$out"
everything "$1" "$out/old" >"$out/old.txt"
everything "$2" "$out/new" >"$out/new.txt"
awk '{ hash = $1; sub(/^[^ ]+  /, "") }
     NR == FNR { old[$0] = hash; next }
     !($0 in old) { print "only new: " $0; bad++; next }
     old[$0] != hash { print "differs:  " $0; bad++ }
     { delete old[$0]; all++ }
     END { for (path in old) { print "only old: " path; bad++ }
           if (bad) { print bad " files differ"; exit 1 }
           print all " files are the same" }' "$out/old.txt" "$out/new.txt" || exit 1
