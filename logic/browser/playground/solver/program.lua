-- One program of stage 1 in clingo: ground it, and do what `task` says. Answers are lines that begin with @.
local clingo = require("clingo")

local function say(...) print("@" .. table.concat({...}, "\t")) end

-- All symbols of a signature, in clingo's order.
local function symbols(prg, name, arity)
  local found = {}
  for atom in prg.symbolic_atoms:by_signature(name, arity) do found[#found + 1] = atom.symbol end
  table.sort(found)
  return found
end

-- The variables in order: name, turn, whether they pick one value, and options {value, weight} in order. Of two weights
-- of one option the last stands, in the order in which they are grounded.
local function variables(prg)
  local found, by_name, several, turns = {}, {}, {}, {}
  for _, symbol in ipairs(symbols(prg, "picks", 2)) do several[tostring(symbol.arguments[1])] = true end
  for _, symbol in ipairs(symbols(prg, "turn", 2)) do
    turns[tostring(symbol.arguments[1])] = symbol.arguments[2].number
  end
  for atom in prg.symbolic_atoms:by_signature("option", 3) do
    local name, value, weight = table.unpack(atom.symbol.arguments)
    local key = tostring(name)
    if not by_name[key] then
      by_name[key] = { name = name, turn = turns[key] or 0, single = not several[key], options = {}, by_value = {} }
      found[#found + 1] = by_name[key]
    end
    local variable, text = by_name[key], tostring(value)
    if not variable.by_value[text] then
      variable.by_value[text] = { value = value }
      table.insert(variable.options, variable.by_value[text])
    end
    variable.by_value[text].weight = tostring(weight)
  end
  table.sort(found, function(a, b) return a.name < b.name end)
  for _, variable in ipairs(found) do
    table.sort(variable.options, function(a, b) return a.value < b.value end)
  end
  return found
end

-- Where an atom is not in the program its literal is nil.
local function literal(prg, text)
  local atom = prg.symbolic_atoms:lookup(clingo.parse_term(text))
  return atom and atom.literal
end

-- No layout has all atoms of a nogood: {atom, holds} in pairs. An atom that can never hold fails anyway.
local function exclude(prg, backend, nogood, more)
  local body = { table.unpack(more or {}) }
  for _, each in ipairs(nogood) do
    local found = literal(prg, each[1])
    if found then body[#body + 1] = each[2] and found or -found elseif each[2] then return end
  end
  backend:add_rule{ head = {}, body = body }
end

local function assumptions(prg, holds, fails)
  local assumed = {}
  for _, text in ipairs(holds) do assumed[#assumed + 1] = { clingo.parse_term(text), true } end
  for _, text in ipairs(fails) do assumed[#assumed + 1] = { clingo.parse_term(text), false } end
  return assumed
end

-- Makes the solver branch on the picks in the sampled order, each to be taken where it still can be: the first model is
-- then the first by these picks, as in logic/layout/branching.py.
local Brancher = {}
Brancher.__index = Brancher
function Brancher:init(init)
  self.queue = {}
  for place, pick in ipairs(self.picks) do
    self.queue[place] = init:solver_literal(pick)
    init:add_watch(self.queue[place])
    init:add_watch(-self.queue[place])
  end
end
function Brancher:propagate() end
function Brancher:decide(_, assignment, fallback)
  local place, queue = 1, self.queue
  while queue[place] do
    local taken = assignment:value(queue[place])
    if taken == nil then return queue[place] end
    place = taken and self.after[place] or place + 1
  end
  return fallback
end

-- Difference constraints, as clingo-dl has them: line(a) - line(b) <= c wherever an atom &diff holds. A model with a
-- negative cycle is refused for the atoms of that cycle (Bellman and Ford).
local Differences = {}
Differences.__index = Differences
function Differences:init(init)
  self.edges, self.nodes = {}, {}
  for atom in init.theory_atoms do
    if atom.term.name == "diff" then
      local difference = atom.elements[1].terms[1]
      local from, to = tostring(difference.arguments[2]), tostring(difference.arguments[1])
      self.nodes[from], self.nodes[to] = true, true
      local literal = init:solver_literal(atom.literal)
      init:add_watch(literal)
      local bound = 0 -- a sum of numbers
      for number in tostring(atom.guard[2]):gsub("[()]", ""):gmatch("[+-]?%d+") do bound = bound + tonumber(number) end
      self.edges[#self.edges + 1] = { from, to, bound, literal }
    end
  end
end
function Differences:cycle(assignment)
  local distance, reached, last = {}, {}, nil
  local held = {}
  for _, edge in ipairs(self.edges) do if assignment:value(edge[4]) then held[#held + 1] = edge end end
  local number = 0
  for node in pairs(self.nodes) do distance[node], number = 0, number + 1 end
  for _ = 1, number + 1 do
    last = nil
    for _, edge in ipairs(held) do
      if distance[edge[1]] + edge[3] < distance[edge[2]] then
        distance[edge[2]], reached[edge[2]], last = distance[edge[1]] + edge[3], edge, edge[2]
      end
    end
    if not last then return nil end
  end
  for _ = 1, number do last = reached[last][1] end -- now on the cycle
  local clause, node = {}, last
  repeat
    clause[#clause + 1] = -reached[node][4]
    node = reached[node][1]
  until node == last
  return clause
end
function Differences:propagate(control)
  local clause = self:cycle(control.assignment)
  if clause then control:add_clause{ clause } end
end
Differences.check = Differences.propagate

-- A model's atoms, or nil.
local function model(prg, assumed)
  local found
  prg:solve{ assumptions = assumed, on_model = function(m)
    found = m:symbols{ shown = true }
    table.sort(found)
    return false
  end }
  return found
end

local tasks = {}

-- What the variables are, and the atoms of the signatures that are asked for.
function tasks.read(prg)
  for _, variable in ipairs(variables(prg)) do
    say("variable", variable.turn, tostring(variable.single), #variable.options)
    for _, option in ipairs(variable.options) do say("weight", option.weight) end
  end
  for _, signature in ipairs(task.atoms or {}) do
    for _, symbol in ipairs(symbols(prg, signature[1], signature[2])) do say("atom", tostring(symbol)) end
  end
end

-- A layout by the order of the options, counted from 1, and for each the place to go on at once it is taken.
function tasks.sample(prg)
  local backend = prg:backend()
  for _, nogood in ipairs(task.nogoods) do exclude(prg, backend, nogood) end
  local picks, all = {}, {}
  for _, variable in ipairs(variables(prg)) do
    for _, option in ipairs(variable.options) do
      all[#all + 1] = literal(prg, "pick(" .. tostring(variable.name) .. "," .. tostring(option.value) .. ")")
    end
  end
  for place, option in ipairs(task.order) do picks[place] = all[option] end
  prg:register_propagator(setmetatable({ picks = picks, after = task.after }, Brancher))
  local found = model(prg, assumptions(prg, task.holds, task.fails))
  if found then
    say("model")
    for _, symbol in ipairs(found) do say("atom", tostring(symbol)) end
  end
end

-- Statements, each atoms that hold or not, that have no layout together, and have one with any of them left out. Layouts are
-- told with the statements that they keep: stage 2 may yet refute them.
function tasks.conflict(prg)
  local backend = prg:backend()
  for _, nogood in ipairs(task.nogoods) do exclude(prg, backend, nogood) end

  -- Some of these statements that have no layout by themselves; nil, and the layout told, where all have one.
  local function core(kept)
    local assumed, statement_of = {}, {}
    for _, number in ipairs(kept) do
      for _, each in ipairs(task.statements[number]) do
        local known = literal(prg, each[1])
        if known then
          assumed[#assumed + 1] = { clingo.parse_term(each[1]), each[2] }
          statement_of[each[2] and known or -known] = number
        elseif each[2] then
          return { number }
        end
      end
    end
    local handle, found, needed = prg:solve{ assumptions = assumed, yield = true }, nil, {}
    for model in handle:iter() do
      found = model:symbols{ shown = true }
      break
    end
    if not found then
      handle:get()
      for _, each in ipairs(handle:core()) do needed[statement_of[math.tointeger(each)]] = true end
    end
    handle:close()
    if found then
      table.sort(found)
      say("keeps", table.unpack(kept))
      for _, symbol in ipairs(found) do say("atom", tostring(symbol)) end
      return nil
    end
    local some = {}
    for _, number in ipairs(kept) do if needed[number] then some[#some + 1] = number end end
    return some
  end

  local needed = {}
  for number = 1, #task.statements do needed[number] = number end
  needed = core(needed)
  if not needed or task.once then return end
  -- A rule is more readily left out than the facts above it, which it may stand in for.
  for number = #task.statements, 1, -1 do
    local fewer = {}
    for _, each in ipairs(needed) do if each ~= number then fewer[#fewer + 1] = each end end
    if #fewer < #needed then needed = core(fewer) or needed end
  end
  say("conflict", table.unpack(needed))
end

local MOST_LAYOUTS = task.mostLayouts

-- The fewest statements that have no layout together, of these the first: as logic/proofs/least.py. What a layout leaves out holds
-- a statement of each conflict, so a smallest set that has one of each is a conflict, or shows another layout.
function tasks.fewest(prg)
  prg.configuration.solver.heuristic = "Domain"
  local all = {}
  for number, literals in ipairs(task.statements) do
    all[number] = {}
    for _, each in ipairs(literals) do
      if literal(prg, each[1]) then
        table.insert(all[number], { clingo.parse_term(each[1]), each[2] })
      elseif each[2] then
        return say("conflict", number)
      end
    end
  end
  local hitting = clingo.Control{"--opt-strategy=usc"}
  hitting:add("base", {}, "{ take(1.." .. #all .. ") }. #minimize { 1@2,N : take(N); N@1,N : take(N) }. #show take/1.")
  hitting:ground{ { "base", {} } }
  local function smallest()
    local found = {}
    hitting:solve{ on_model = function(m)
      found = {}
      for _, symbol in ipairs(m:symbols{ shown = true }) do found[symbol.arguments[1].number] = true end
    end }
    return found
  end
  local function left_out(some)
    local assumed, found = {}, nil
    for number in pairs(some) do table.move(all[number], 1, #all[number], #assumed + 1, assumed) end
    prg:solve{ assumptions = assumed, on_model = function(m)
      found = {}
      for number, literals in ipairs(all) do
        for _, each in ipairs(literals) do
          if m:contains(each[1]) ~= each[2] then found[number] = true end
        end
      end
      return false
    end }
    return found
  end
  local layouts = 0
  while true do
    local some, isConflict = smallest(), true
    for found in function() return left_out(some) end do
      isConflict, layouts = false, layouts + 1
      local rule = {}
      for number in pairs(found) do
        some[number] = true
        rule[#rule + 1] = "not take(" .. number .. ")"
      end
      if #rule == 0 or layouts >= MOST_LAYOUTS then return tasks.conflict(prg) end
      hitting:add("layout" .. layouts, {}, ":- " .. table.concat(rule, ", ") .. ".")
      hitting:ground{ { "layout" .. layouts, {} } }
    end
    if isConflict then
      local conflict = {}
      for number in pairs(some) do conflict[#conflict + 1] = number end
      table.sort(conflict)
      return say("conflict", table.unpack(conflict))
    end
  end
end

local function work(prg)
  if task.differences then prg:register_propagator(setmetatable({}, Differences)) end
  local parts = { { "base", {} } }
  for _, text in ipairs(task.parts) do
    local term = clingo.parse_term(text)
    parts[#parts + 1] = { term.name, term.arguments }
  end
  parts[#parts + 1] = { "pick", {} }
  prg:ground(parts)
  tasks[task.what](prg)
  say("done")
end

-- An error that left main would end the module.
function main(prg)
  local done, why = pcall(work, prg)
  if not done then say("failed", (tostring(why):gsub("%s+", " "))) end
end
