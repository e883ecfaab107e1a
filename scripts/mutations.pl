#!/usr/bin/perl
# Does the accuracy suite notice a fault of one or two percent? Puts the faults of tests/mutations.txt, one at a time, into a
# copy of the sources and runs the suite there. Faults of the group `lib` are those of code that no scene description asks for
# yet: unit tests run it (`run_suite`). Prints what noticed each; fails if one went unnoticed.
#
#   scripts/mutations.pl            all of them
#   scripts/mutations.pl --check    only whether each can be put in
#   scripts/mutations.pl offset     those whose name has this in it
use strict;
use warnings;
use Cwd qw(abs_path);
use File::Basename qw(dirname);

my $root = abs_path(dirname($0) . '/..');
my $copy = "$root/target/mutations/source";
my $is_check = @ARGV && $ARGV[0] eq '--check';
my $only = $is_check ? '' : $ARGV[0] // '';
die "usage: mutations.pl [--check | part of a name]\n" if @ARGV > 1 || $only =~ /\A-/;

sub slurp { my ($path) = @_; local $/; open my $file, '<', $path or die "$path: $!\n"; return scalar <$file>; }
sub spew { my ($path, $text) = @_; open my $file, '>', $path or die "$path: $!\n"; print $file $text; close $file or die "$path: $!\n"; }

# Each block: name, group, file, the text and what replaces it.
my @faults;
for my $block (split /\n\n+/, slurp("$root/tests/mutations.txt")) {
    next if $block =~ /\A#/;
    my ($name, $group, $file, $lines) = $block =~ /\A(.+)\nin: (\w+)\nfile: (\S+)\n((?:[-+] .*\n?)+)\z/
        or die "tests/mutations.txt: not a fault:\n$block\n";
    my $old = join "\n", map { /^- (.*)/ ? $1 : () } split /\n/, $lines;
    my $new = join "\n", map { /^\+ (.*)/ ? $1 : () } split /\n/, $lines;
    my $count = () = slurp("$root/$file") =~ /\Q$old\E/g;
    die "$name: its text occurs $count times in $file, not once\n" unless $count == 1;
    push @faults, { name => $name, group => $group, file => $file, old => $old, new => $new };
}
if ($is_check) {
    print scalar(@faults), " faults can be put in\n";
    exit 0;
}

# The copy has what git knows, as it is in the working tree.
system('rm', '-rf', $copy) == 0 and system('mkdir', '-p', $copy) == 0 or die "cannot make $copy\n";
system("cd '$root' && git ls-files -z | tar --null -cf - -T - | tar -xf - -C '$copy'") == 0 or die "cannot copy\n";
$ENV{CARGO_TARGET_DIR} = "$root/target/mutations/build";

# Runs a group of the suite, or all of it; whether it was quiet, and its comparisons that failed.
sub run_suite {
    my ($filter) = @_;
    my $tests = $filter eq 'lib::'
        ? '--lib -- render::tests:: emitter::environment:: scene::motion:: scene::varying:: integrator::wave::'
        : "--test accuracy -- $filter";
    my $output = `cd '$copy' && cargo test --quiet --locked $tests 2>&1`;
    my $is_quiet = $? == 0;
    die "the copy does not build:\n$output" if $output =~ /could not compile/;
    my @rows = $output =~ /^([A-Z]\d+\w* .+?): expected /mg;
    my @panicked = $output =~ /^thread '(.+?)'.* panicked/mg;
    return ($is_quiet, @rows, @panicked);
}

my ($is_quiet, @failed) = run_suite('');
die "the suite fails without a fault:\n", map { "  $_\n" } @failed unless $is_quiet;

my $missed = 0;
for my $fault (grep { index($_->{name}, $only) >= 0 } @faults) {
    my $text = slurp("$copy/$fault->{file}");
    (my $broken = $text) =~ s/\Q$fault->{old}\E/$fault->{new}/;
    spew("$copy/$fault->{file}", $broken);
    ($is_quiet, @failed) = run_suite("$fault->{group}::");
    ($is_quiet, @failed) = run_suite('') if $is_quiet;
    spew("$copy/$fault->{file}", $text);
    $missed += $is_quiet;
    printf "%-6s  %s: %s\n", $is_quiet ? 'MISSED' : 'caught', $fault->{name},
        @failed ? scalar(@failed) . ' comparisons, such as ' . $failed[0] : $is_quiet ? 'nothing' : 'a test failed';
}
print $missed ? "$missed faults went unnoticed\n" : "every fault was noticed\n";
exit($missed ? 1 : 0);
