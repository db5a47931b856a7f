:- module(answers, [as_json/2, answer_within/5, reason_record/2]).

/** <module> Answers as JSON */

:- use_module(library(http/json)).

%!  as_json(+Value, -Text) is det.

as_json(Value, Text) :-
    with_output_to(string(Text), json_write_dict(current_output, Value, [width(0)])).

%!  answer_within(+Limit, :Goal, ?Answer, :Recorded, -Json) is det.
%
%   Json is the record that Recorded makes of the Answer of a Goal, with "inferences", how many it took; {"limit": true}
%   where it takes more than Limit.

:- meta_predicate answer_within(+, 0, ?, 2, -).

answer_within(Limit, Goal, Answer, Recorded, Json) :-
    statistics(inferences, Before),
    call_with_inference_limit(Goal, Limit, Result),
    statistics(inferences, After),
    Inferences is After - Before,
    (   Result == inference_limit_exceeded
    ->  Reply = _{limit:true}
    ;   call(Recorded, Answer, Record), Reply = Record.put(inferences, Inferences) ),
    as_json(Reply, Json).

%!  reason_record(+Reason, -Record) is det.
%
%   Record is [holds,Atom], [fails,Atom] or [clause,Clause], for a reason as in reasons.pl.

reason_record(not(Atom), [fails,Text])     :- !, term_string(Atom, Text).
reason_record(length(Name), [clause,Text]) :- !, term_string(length(Name), Text).
reason_record(Clause, [clause,Text])       :- functor(Clause, Name, _), memberchk(Name, [size,room_area,whole_area,house_size,house_area,window_size,opening_size,door_width,turning]), !, term_string(Clause, Text).
reason_record(Atom, [holds,Text])          :- term_string(Atom, Text).
