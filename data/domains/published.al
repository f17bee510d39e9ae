% The coarse domain as the published planner has it, for comparison with coarse.al.
%
% Reconstructed from the behaviour of that planner and section IV-A of the paper, with the same scope of modelling:
% it has no geometry, such as insertion paths, drooping ends and room for the hand. After
% an insertion, the hand still holds the beam and must release it; every insertion misaligns every other beam, pinned
% or not; the goal requires neither alignment nor an empty hand. Its plans are not carried out: the fine domain
% belongs to coarse.al. `ramp plan easy-1 --domain data/domains/published.al --coarse --optimal` plans with it.

sort beam.
sort connection.
sort area = { input, intermediate, assembly }.
sort item = beam(beam) + peg(connection).

static base(beam).
static joins(connection, beam, beam).
static enters(beam, beam).               % a male of the first goes into a female of the second
static passes(beam, beam).               % the first goes through the second
static capped(beam, beam, beam).         % the first goes into both others, which are its caps
static beside(area, area).
static awkward(beam).                    % known to the fine domain; nothing here asks for it

beside(input, intermediate).
beside(intermediate, assembly).
beside(A, B) if beside(B, A).
capped(A, B, C) if enters(A, B), -passes(A, B), enters(A, C), -passes(A, C), B != C.

inertial fluent at(area).
inertial fluent in_hand(item).
inertial fluent place(item, area).
inertial fluent in_assembly(beam).
inertial fluent misaligned(beam).
inertial fluent pinned(connection).

defined fluent full.
defined fluent supported(beam).
defined fluent open(connection).
defined fluent between(connection, beam).
defined fluent crooked(connection).
defined fluent built_in(item).

-at(B) if at(A), A != B.
-place(I, B) if place(I, A), A != B.
place(I, A) if in_hand(I), at(A).

full if in_hand(_).
supported(B) if joins(_, B, A), in_assembly(A).
open(C) if joins(C, A, B), in_assembly(A), in_assembly(B), -pinned(C).
between(C, B) if joins(C, B, _).
crooked(C) if joins(C, B, _), misaligned(B).
built_in(beam(B)) if in_assembly(B).
built_in(peg(C)) if pinned(C).

action move(area).
move(A) causes at(A).
impossible move(A) if at(B), -beside(A, B).
impossible move(_) if in_hand(I), built_in(I).

action pick_up(item).
pick_up(I) causes in_hand(I).
impossible pick_up(_) if full.
impossible pick_up(I) if at(A), -place(I, A).
impossible pick_up(I) if built_in(I).

action put_down(item).
put_down(I) causes -in_hand(I).
impossible put_down(I) if -in_hand(I).

action assemble(beam).
assemble(B) causes in_assembly(B).
assemble(B) causes misaligned(A) if in_assembly(A), -base(A), A != B.
impossible assemble(B) if in_assembly(B).
impossible assemble(B) if -in_hand(beam(B)).
impossible assemble(_) if -at(assembly).
impossible assemble(B) if -supported(B).
impossible assemble(A) if capped(A, B, C), in_assembly(B), in_assembly(C).
impossible assemble(B) if capped(A, B, C), -in_assembly(A), in_assembly(C).
impossible assemble(B) if passes(A, B), in_assembly(A).
impossible assemble(_) if misaligned(_).
impossible assemble(B) if open(C), -between(C, B).

action fasten(connection).
fasten(C) causes pinned(C).
impossible fasten(C) if -open(C).
impossible fasten(C) if -in_hand(peg(C)).
impossible fasten(_) if -at(assembly).
impossible fasten(C) if crooked(C).

action push(beam).
push(B) causes -misaligned(B).
impossible push(B) if -in_assembly(B).
impossible push(B) if base(B).
impossible push(_) if full.
impossible push(_) if -at(assembly).

initially at(input).
initially place(beam(B), input) if -base(B).
initially place(peg(C), input).
initially in_assembly(B) if base(B).

goal in_assembly(B).
goal pinned(C).
