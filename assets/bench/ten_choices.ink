// The same talk as in ten_choices.yaml, for inkjs: ten choices, each one of four.
VAR n = 0
-> hub
=== hub ===
{ n >= 10: -> END }
What will it be?
+ [Praise it.] That is kind of you. -> next
+ [Ask for its story.] It was my grandmother's. -> next
+ [Find a flaw.] You have sharp eyes. -> next
+ [Talk about the weather.] The awning holds, so far. -> next
=== next ===
~ n = n + 1
-> hub
