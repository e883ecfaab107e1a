#!/usr/bin/perl
# What filters of textures gain and cost: a floor of bricks that goes to the horizon, the same in a mirror ball, and through a glass
# ball, with each filter at 1, 4, 16 and 64 samples a pixel, against a picture with the default filter and many samples. Prints
# the tables of docs/design/textures.md: relMSE, and relMSE times seconds, over that of the default filter.
#
#   cargo build --release --example etendue && scripts/texture_filters.pl [PROGRAM]
use strict;
use warnings;
use Cwd qw(abs_path);
use File::Basename qw(dirname);
use File::Path qw(make_path);
use JSON::PP;

my $root = abs_path(dirname($0) . '/..');
my $program = $ARGV[0] // "$root/target/release/examples/etendue";
my $folder = "$root/out/filters";
my @filters = qw(bilinear mip ewa stochastic);
my @samples = (1, 4, 16, 64);
my $reference_samples = 8192;
make_path($folder);

sub run {
    my $output = qx(@_ 2>&1);
    die "@_:\n$output" if $?;
    return $output;
}
sub read_json { my ($path) = @_; local $/; open my $file, '<', $path or die "$path: $!\n"; return decode_json(<$file>); }

# The camera looks along the floor; balls stand before it.
sub scene {
    my ($ball, $filter) = @_;
    my @surfaces = ({
        geometry => 'quad', 'vertex-1' => [-200, 0, 10], 'vertex-2' => [200, 0, 10], 'vertex-3' => [200, 0, -400],
        'vertex-4' => [-200, 0, -400], material => 'floor',
    });
    push @surfaces, { geometry => 'sphere', origin => [0, 1, -1], radius => 1, material => $ball } if $ball ne 'floor';
    return {
        etendue => 1,
        camera => { origin => [0, 1.2, 3], lookAt => [0, 0.9, 0], up => [0, 1, 0], fieldOfView => 40 },
        lights => [{ type => 'environment', color => [1, 1, 1] }],
        textures => [{
            name => 'bricks', type => 'image', file => "$root/scenes/textures/bricks.png", filter => $filter, scale => [200, 205],
        }],
        materials => [
            { name => 'floor', type => 'diffuse', color => [1, 1, 1], textures => { color => 'bricks' } },
            { name => 'mirror', type => 'reflective', color => [0.95, 0.95, 0.95] },
            { name => 'glass', type => 'refractive', refractionIndex => 1.5 },
        ],
        surfaces => \@surfaces,
    };
}

sub render {
    my ($ball, $filter, $samples, $name, $seed) = @_;
    my $path = "$folder/$name.json";
    open my $file, '>', $path or die "$path: $!\n";
    print $file JSON::PP->new->canonical->encode(scene($ball, $filter));
    close $file or die "$path: $!\n";
    run($program, 'render', $path, '-o', "$folder/$name.exr", '--resolution 160x120', '--spp', $samples, '--seed', $seed,
        '--max-depth 6', '--stats', "$folder/$name.stats.json", '--quiet');
    return read_json("$folder/$name.stats.json")->{seconds}{render};
}

for my $ball (qw(floor mirror glass)) {
    render($ball, 'bilinear', $reference_samples, "$ball-reference", 99);
    printf "\n%s\n| filter | %s |\n|---|%s\n", $ball, join(' | ', map { "relMSE, $_ spp | x s" } @samples), '---|---|' x @samples;
    my %default;
    for my $filter (@filters) {
        my @cells;
        for my $samples (@samples) {
            # Several seeds, so that single pictures do not decide.
            my ($error, $seconds) = (0, 0);
            my $rounds = 4;
            for my $seed (1 .. $rounds) {
                my $name = "$ball-$filter";
                $seconds += render($ball, $filter, $samples, $name, $seed) / $rounds;
                my $found = decode_json(run($program, 'compare', "$folder/$name.exr", "$folder/$ball-reference.exr", '--json', '--no-flip'));
                $error += $found->{rel_mse_to_mean} / $rounds;
            }
            $default{$samples} //= [$error, $error * $seconds];
            push @cells, sprintf '%.2e (%.2f) | %.2f', $error, $error / $default{$samples}[0],
                $error * $seconds / $default{$samples}[1];
        }
        printf "| `%s` | %s |\n", $filter, join ' | ', @cells;
    }
}
